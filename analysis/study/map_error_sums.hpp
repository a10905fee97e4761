// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/map_scores.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/statistics/sums.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// Errors of one landmark over the runs that have it in their map.
struct LandmarkErrors {
  std::uint32_t runs = 0;       ///< number of runs with the landmark in the map
  std::uint32_t valid = 0;      ///< number of runs with a finite NEES
  double rms = kNaN;            ///< [m] RMS position error
  double anees = kNaN;          ///< [1] average NEES of two components
  Interval bounds{kNaN, kNaN};  ///< bounds of anees for `valid` runs
};

/// Errors of the final maps of a cell over its complete runs.
struct MapErrors {
  std::size_t undefined = 0;              ///< number of landmarks, over all runs, that have no NEES
  std::vector<LandmarkErrors> landmarks;  ///< {landmark}; empty where association is unknown
  std::string missing = {};               ///< reason why there are no numbers; else empty

  /// Share of the landmarks with a NEES whose anees is inside its bounds; NaN if there are none.
  double share_inside() const;
};

/// Adds up complete runs in the order of the calls.
class MapErrorSums {
 public:
  /// Adds a run; `run` is nullopt if its map is not stored or not whole.
  void add(const std::optional<MapScores>& run);
  /// The result at `level` for maps that are judged by the criteria `map`.
  MapErrors result(double level, const MapCriteria& map) const;
  static constexpr auto parts() {
    return std::tuple(added(&MapErrorSums::landmarks_, &MapErrorSums::n_runs_,
                            &MapErrorSums::n_maps_, &MapErrorSums::undefined_));
  }

 private:
  struct LandmarkSums {
    double squares = 0.0, nees = 0.0;
    std::uint32_t runs = 0, valid = 0;
    static constexpr auto parts() {
      return std::tuple(added(&LandmarkSums::squares, &LandmarkSums::nees, &LandmarkSums::runs,
                              &LandmarkSums::valid));
    }
  };
  std::string reason(const MapCriteria& map) const;

  std::vector<LandmarkSums> landmarks_;  ///< {landmark} sums over the runs
  std::size_t n_runs_ = 0, n_maps_ = 0, undefined_ = 0;
};

}  // namespace montecarta::analysis
