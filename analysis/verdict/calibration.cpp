// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/calibration.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

namespace montecarta::analysis {
namespace {

constexpr std::array kComponents = {"x", "y", "heading"};

/// Judges the transforms of a cell by bands that all hold together (Bonferroni). A band is kept for
/// each number of values, since the numbers are nearly always the same.
class PitJudge {
 public:
  PitJudge(std::span<const RunPits> runs, std::size_t tests, double level)
      : runs_(runs), level_(1.0 - (1.0 - level) / static_cast<double>(tests)) {}

  void add(JudgedPits blank, PitOf kind, const std::function<double(const RunPits&)>& value_of) {
    std::vector<double> values;
    for (const RunPits& run : runs_) {
      const double value = value_of(run);
      if (std::isfinite(value)) values.push_back(value);
    }
    blank.undefined = runs_.size() - values.size();
    const auto [band, is_new] = bands_.try_emplace(values.size());
    if (is_new) band->second = ecdf_band(values.size(), level_);
    blank.test = judge_uniformity(values, band->second, kind);
    found.push_back(std::move(blank));
  }

  std::vector<JudgedPits> found;

 private:
  std::span<const RunPits> runs_;
  double level_;
  std::map<std::size_t, EcdfBand> bands_;
};

/// The largest number of tests that a cell can have, so that cells with as many runs have the same
/// band.
std::size_t most_tests(const RunPits& run) {
  const bool has_components = run.has_pose || run.has_rank || run.has_landmark;
  const std::size_t of_components =
      2 * kQuarters * kComponents.size() + run.rank_nees.size() + run.landmark.size();
  return run.nees.size() + (has_components ? of_components : 0);
}

}  // namespace

std::vector<JudgedPits> CalibrationSums::result(std::span<const double> times, double level) const {
  if (runs_.empty()) return {};
  const RunPits& first = runs_.front();
  PitJudge judge(runs_, most_tests(first), level);
  const auto scans = calibration_scans(times.size());
  const auto add_pose = [&](const char* by, auto RunPits::*pits) {
    for (std::size_t m = 0; m < kQuarters; ++m) {
      for (std::size_t c = 0; c < kComponents.size(); ++c) {
        judge.add({kComponents[c], by, times[scans[m]], 0, {}}, PitOf::error,
                  [=](const RunPits& run) { return (run.*pits)[m][c]; });
      }
    }
  };
  if (first.has_pose) add_pose("Gaussian", &RunPits::pose);
  if (first.has_rank) add_pose("particles", &RunPits::rank);
  if (first.has_landmark) {
    for (std::size_t c = 0; c < first.landmark.size(); ++c) {
      judge.add({std::string("landmark ") + kComponents[c], "Gaussian", times.back(), 0, {}},
                PitOf::error, [=](const RunPits& run) { return run.landmark[c]; });
    }
  }
  const auto add_nees = [&](const char* by, auto RunPits::*pits) {
    for (std::size_t m = 0; m < kQuarters; ++m) {
      judge.add({kNees, by, times[scans[m]], 0, {}}, PitOf::squared_error,
                [=](const RunPits& run) { return (run.*pits)[m]; });
    }
  };
  if (first.has_nees) add_nees("Gaussian", &RunPits::nees);
  if (first.has_rank) add_nees("particles", &RunPits::rank_nees);
  return std::move(judge.found);
}

}  // namespace montecarta::analysis
