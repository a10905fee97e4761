// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/whitened_run.hpp"
#include "analysis/verdict/verdict.hpp"
#include "analysis/verdict/worst_direction.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Keeps the errors of a study of fewer than kFewestRunsOfAPlan runs, and tests them along their
/// drives (STATISTICS 20), which show as much as the errors forget. So few runs hardly show how
/// much runs differ.
class AlongDrive {
 public:
  void add(const WhitenedRun& run);
  void merge(AlongDrive& next);
  /// Number of runs with errors; those of kFewestRunsOfAPlan runs and more are not kept.
  std::size_t runs() const { return runs_; }
  /// Whether the errors forget so fast that averages over a run hardly depend on their law, which
  /// the tests take to be Gaussian: each run is worth ten independent scans at least.
  bool have_short_memory() const;
  /// The families of size and, of several components, of components; empty without errors.
  std::vector<MemberTest> tests(std::span<const std::string> components) const;
  /// The same by the law of errors that are independent from scan to scan (STATISTICS (9.5)), and
  /// the family of stretches that end at the scans `ends` and are called `stretches`.
  std::vector<MemberTest> white_tests(std::span<const std::string> components,
                                      std::span<const std::size_t> ends,
                                      std::span<const Member> stretches) const;

 private:
  void forget_if_enough();

  std::size_t runs_ = 0;
  std::size_t dimension_ = 0;
  /// {run}{scan, component} errors in units of their covariance, and of each component's deviation.
  ErrorsOfRuns whitened_, standardised_;
};

}  // namespace montecarta::analysis
