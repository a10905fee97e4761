// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/joint_scores.hpp"
#include "analysis/run/study_facts.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/verdict/summed_error.hpp"
#include "analysis/verdict/verdict.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// Pose and map together over the complete runs of a cell: 1 is expected.
struct JointConsistency {
  std::vector<double> average;      ///< [1] {joint} NEES per component over runs
  std::vector<Interval> bounds;     ///< {joint} of the average, for all rows together
  std::vector<double> dimension;    ///< [1] {joint} mean over runs
  std::vector<std::uint32_t> runs;  ///< {joint} with a defined NEES
  std::uint64_t samples = 0;        ///< rows x complete runs
  std::uint64_t undefined = 0;      ///< of them, without a NEES
  Verdict verdict;                  ///< by size and rows
  bool stored = false;              ///< whether the cell has joint estimates
  std::string missing = {};         ///< why stored estimates were not judged; else empty

  bool is_judged() const { return verdict.answer != Answer::untested; }
};

/// Adds up complete runs in the order of the calls.
class JointNeesSums {
 public:
  /// `times` [s] of the rows.
  explicit JointNeesSums(std::span<const double> times);

  /// Adds a run; empty if the run has no joint estimates.
  void add(std::span<const JointScore> run);
  /// `identities_known`: whether landmarks of map and truth are matched by identity.
  JointConsistency result(double level, bool identities_known, double within = kUsualMargin) const;
  static constexpr auto parts() {
    using Sums = JointNeesSums;
    return std::tuple(added(&Sums::nees_, &Sums::all_dimensions_, &Sums::n_runs_));
  }

 private:
  std::vector<double> times_;
  SummedError nees_;                    ///< {joint}
  std::vector<double> all_dimensions_;  ///< {joint} also where the NEES is not defined
  std::uint64_t n_runs_ = 0;            ///< with joint estimates
};

}  // namespace montecarta::analysis
