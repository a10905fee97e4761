// SPDX-License-Identifier: BSD-3-Clause
// Number of landmarks in the map, and surveyed beacons that were found in it.
#include "analysis/run/measured_run.hpp"
#include "analysis/study/metric.hpp"

#include <vector>

namespace montecarta::analysis {
namespace {

template <double BeaconScores::*kValue>
double of_beacons(const MeasuredRun& run) {
  return run.beacons ? (*run.beacons).*kValue : kNaN;
}

double landmarks_in_map(const MeasuredRun& run) {
  const RunRows& rows = run.rows;
  if (!rows.map_size.empty()) return rows.map_size.back();
  return rows.final_map ? static_cast<double>(rows.final_map->places().size()) : kNaN;
}

constexpr Score kBeaconsScores[] = {
    {"map_landmarks", "1", "landmarks in the final map", landmarks_in_map, Better::neither},
    {"beacons_found", "1", "surveyed beacons found", of_beacons<&BeaconScores::found>,
     Better::higher},
    {"beacon_rms", "m", "RMS error of the beacons found", of_beacons<&BeaconScores::rms>},
    {"beacon_aligned_rms", "m", "RMS error of the beacons found, aligned",
     of_beacons<&BeaconScores::aligned_rms>},
};

constexpr ScanSeries kMapSize[] = {{"map_landmarks", "1", [](const MeasuredRun& run) {
                                      return run.rows.truth.empty() ? run.rows.map_size
                                                                    : std::vector<double>();
                                    }}};

}  // namespace

Metric map_size_metric() { return {.scan_series = kMapSize}; }

Metric beacons_metric() { return {.scores = kBeaconsScores, .scores_are_numbers = false}; }

}  // namespace montecarta::analysis
