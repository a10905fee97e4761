// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_rows.hpp"
#include "analysis/metrics/consistency.hpp"
#include "analysis/statistics/nees_bounds.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Normalised error squared of pose and map together, of one run at one scan.
struct JointScore {
  double nees = 0.0;          ///< NaN where error or covariance is not finite, or P not positive
                              ///< definite
  std::size_t dimension = 0;  ///< 3 + 2 x landmarks in the map
};

/// A JointScore for each row of `rows`, which are taken at these scans. `truth` {scan, 3}
/// [m, m, rad]; `landmarks` [m] by identity.
std::vector<JointScore> joint_scores(const JointRows& rows, std::span<const std::uint32_t> scans,
                                     std::span<const double> truth,
                                     std::span<const Eigen::Vector2d> landmarks);

/// The sum of the defined ones divided by the sum of their dimensions; NaN where there is none.
double nees_per_component(std::span<const JointScore> scores);

/// Pose and map together over the complete runs of a cell: 1 is expected.
struct JointConsistency {
  std::vector<double> average;      ///< [1] {joint} NEES per component over runs
  std::vector<Interval> bounds;     ///< {joint} of the average, for all rows together
  std::vector<double> dimension;    ///< [1] {joint} mean over runs
  std::vector<std::uint32_t> runs;  ///< {joint} with a defined NEES
  std::uint64_t samples = 0;        ///< rows x complete runs
  std::uint64_t undefined = 0;      ///< of them, without a NEES
  Verdict verdict = Verdict::untested;
  double within = kUsualMargin;            ///< what counts as consistent
  std::optional<std::size_t> highest_row;  ///< of the rows outside their bounds that farthest above
  std::optional<std::size_t> lowest_row;   ///< and that farthest below
  std::optional<std::uint64_t> more_runs;  ///< that decide what is undecided
  bool stored = false;                     ///< whether the cell has joint estimates
  std::string missing = {};  ///< why those that are stored were not judged; empty where they were
};

/// Where the expected average of a row lies, as far as it is off by a factor.
Interval ratio_of_row(const JointConsistency& joint, std::size_t row);

/// Adds up complete runs in the order of the calls.
class JointNeesSums {
 public:
  /// Nothing: the run has no joint estimates.
  void add(std::span<const JointScore> run);
  /// `identities_known`: whether anybody knows which landmark is which.
  /// `within`: rows whose intervals are all inside [1 / within, within] are consistent.
  JointConsistency result(double level, bool identities_known, double within = kUsualMargin) const;

 private:
  struct Sums {
    double nees = 0.0, dimensions = 0.0, all_dimensions = 0.0;
    std::uint32_t runs = 0;
  };
  std::vector<Sums> rows_;    ///< {joint}
  std::uint64_t n_runs_ = 0;  ///< with joint estimates
};

}  // namespace montecarta::analysis
