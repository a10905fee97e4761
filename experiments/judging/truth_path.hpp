// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/state_rows.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The method that finds the truth at the time of an estimate.
struct TimeMatch {
  double tolerance = 1e-6;   ///< [s] largest difference of times that are the same
  bool interpolate = false;  ///< whether to interpolate linearly, with angles the shorter way round
  /// [s] Longest gap between two rows of the truth that is interpolated; nullopt: ten times the
  /// usual spacing of the truth.
  std::optional<double> longest_gap = {};
  bool is_pair = false;  ///< whether the truth is that of a second estimator (judge --pair)
};

/// What was used of the truths, and what was left out.
struct TruthUse {
  double largest_mismatch = 0.0;         ///< [s] between an estimate and the row of the truth used
  std::string of_mismatch = {};          ///< the estimate's file and time
  std::uint64_t in_gaps = 0;             ///< number of estimates left out in gaps of a truth
  std::string first_gap = {};            ///< the first such gap: file and times
  double longest_crossed = 0.0;          ///< [s] longest gap that was interpolated beyond the usual
  bool interpolates_covariance = false;  ///< whether that of the truth was taken between its rows
  std::uint64_t outside = 0;             ///< number of estimates left out before or after a truth
  std::string first_outside = {};        ///< the first such estimate: file and time
  double bend_squares = 0.0;  ///< [m2] sum of squares of the truth's bend at interpolated positions
  double claimed_squares = 0.0;  ///< [m2] sum of variances that estimates claim for positions there
  std::uint64_t interpolated_positions = 0;

  /// Sentences on what is not as usual. `is_pair` is that of TimeMatch.
  std::vector<std::string> notes(bool is_pair) const;
  std::string note_on_bend(const std::string& other) const;
};

/// The truth at the time of an estimate.
struct TrueState {
  Eigen::VectorXd state;            ///< {width}
  Eigen::MatrixXd covariance = {};  ///< {d, d} of the truth's own error; empty if it has none
};

/// The truth of one run.
class TruthPath {
 public:
  /// Takes the rows of the file `path`, which may have covariances.
  TruthPath(StateRows rows, std::filesystem::path path, const TimeMatch& match);

  /// {row} The truth at the times of the estimates in the file `path`. With `interpolate`, a row in
  /// a gap of the truth, or before or after it, has none and is counted in `use`; without it, that
  /// is an error. Throws StudyError that names both files and the line, also if two estimates have
  /// the same row of the truth, or if no estimate has a truth.
  std::vector<std::optional<TrueState>> at(const StateRows& estimates,
                                           const std::filesystem::path& path, TruthUse& use) const;
  /// [s] Time until which there is a truth, within the tolerance.
  double end() const;

 private:
  TrueState in_row(std::size_t row) const;
  std::optional<TrueState> interpolated(double time, const std::string& estimate,
                                        TruthUse& use) const;
  void add_bend(const StateRows& estimates, std::size_t row, TruthUse& use) const;
  std::size_t row_near(double time, const std::string& estimate) const;
  void require_common_time(const StateRows& estimates, const std::filesystem::path& path) const;
  /// Throws StudyError that says that the times of both files are of different clocks.
  [[noreturn]] void refuse_times(const StateRows& estimates,
                                 const std::filesystem::path& path) const;

  StateRows rows_;
  std::filesystem::path path_;
  TimeMatch match_;
  double usual_gap_, longest_gap_;
};

}  // namespace montecarta::experiments
