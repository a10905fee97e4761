// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/joint_scores.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/verdict/summed_error.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/core/judgement.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// NEES of pose and map together over the complete runs of a cell, divided by the number of
/// components: its expectation is 1. A row is a scan at which joint estimates are stored.
struct JointConsistency {
  std::vector<double> average;      ///< [1] {row} NEES per component over runs
  std::vector<Interval> bounds;     ///< {row} bounds of the average, for all rows together
  std::vector<double> dimension;    ///< [1] {row} number of components, mean over runs
  std::vector<std::uint32_t> runs;  ///< {row} number of runs with a defined NEES
  std::uint64_t samples = 0;        ///< number of samples: rows x complete runs
  std::uint64_t undefined = 0;      ///< number of samples without a NEES
  Verdict verdict;                  ///< verdict by size and rows
  bool stored = false;              ///< whether the cell has joint estimates
  std::string missing = {};         ///< reason why stored estimates were not judged; else empty

  bool is_judged() const { return verdict.answer != Answer::untested; }
};

/// Adds up complete runs in the order of the calls.
class JointNeesSums {
 public:
  /// Makes sums for rows at `times` [s].
  explicit JointNeesSums(std::span<const double> times);

  /// Adds a run; `run` is empty if it has no joint estimates.
  void add(std::span<const JointScore> run);
  /// The result at `level`; `identities_known` is whether landmarks of map and truth are matched by
  /// identity.
  JointConsistency result(double level, bool identities_known, double within = kUsualMargin) const;
  static constexpr auto parts() {
    using Sums = JointNeesSums;
    return std::tuple(added(&Sums::nees_, &Sums::all_dimensions_, &Sums::n_runs_));
  }

 private:
  std::vector<double> times_;
  SummedError nees_;  ///< {row} sums of the NEES
  /// {row} sum of the dimensions, also of runs without a defined NEES.
  std::vector<double> all_dimensions_;
  std::uint64_t n_runs_ = 0;  ///< number of runs with joint estimates
};

}  // namespace montecarta::analysis
