// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/cell_calibration.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <map>

namespace montecarta::analysis {
namespace {

constexpr std::array kComponents = {"x", "y", "heading"};

/// Histograms with the bands of their numbers of values, which are nearly always the same; all of
/// the cell keep them together (Bonferroni).
class Histograms {
 public:
  Histograms(std::span<const RunPits> runs, std::size_t tests, double level)
      : runs_(runs), level_(1.0 - (1.0 - level) / static_cast<double>(tests)) {}

  void add(PitHistogram blank, const std::function<double(const RunPits&)>& value_of) {
    std::vector<double> values;
    for (const RunPits& run : runs_) {
      const double value = value_of(run);
      if (std::isfinite(value)) values.push_back(value);
    }
    blank.undefined = runs_.size() - values.size();
    const auto [band, fresh] = bands_.try_emplace(values.size());
    if (fresh) band->second = band_for(values.size(), level_);
    blank.test = judge_uniformity(values, band->second);
    found.push_back(std::move(blank));
  }

  std::vector<PitHistogram> found;

 private:
  std::span<const RunPits> runs_;
  double level_;
  std::map<std::size_t, CountBand> bands_;
};

/// How many histograms a cell has whose runs are like `run`.
std::size_t tests_of(const RunPits& run) {
  const std::size_t of_pose = 3 * kQuarters;
  return (run.has_pose ? of_pose : 0) + (run.has_rank ? of_pose : 0) + (run.has_landmark ? 2 : 0);
}

}  // namespace

std::vector<PitHistogram> CalibrationSums::result(std::span<const double> times,
                                                  double level) const {
  if (runs_.empty()) return {};
  Histograms histograms(runs_, tests_of(runs_.front()), level);
  const auto scans = calibration_scans(times.size());
  const auto add_pose = [&](const char* by, auto RunPits::*pits) {
    for (std::size_t m = 0; m < kQuarters; ++m) {
      for (std::size_t c = 0; c < 3; ++c) {
        histograms.add({kComponents[c], by, times[scans[m]], 0, {}},
                       [=](const RunPits& run) { return (run.*pits)[m][c]; });
      }
    }
  };
  if (runs_.front().has_pose) add_pose("Gaussian", &RunPits::pose);
  if (runs_.front().has_rank) add_pose("particles", &RunPits::rank);
  if (runs_.front().has_landmark) {
    for (std::size_t c = 0; c < 2; ++c) {
      histograms.add({std::string("landmark ") + kComponents[c], "Gaussian", times.back(), 0, {}},
                     [=](const RunPits& run) { return run.landmark[c]; });
    }
  }
  return std::move(histograms.found);
}

}  // namespace montecarta::analysis
