// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/estimate_source.hpp"
#include "experiments/judging/judging_options.hpp"
#include "experiments/judging/likely_mistakes.hpp"

#include <memory>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The errors of the increments of poses over windows of time. Windows do not overlap. The cells
/// are those of the poses with each window, e.g. odometry.10s. The covariance of an increment is
/// what was added in its window, if the errors of the estimates add up independently, as those of
/// odometry (STATISTICS (19.6)). If those of an estimator were corrected, so that its files have no
/// such covariance, it is the bound (19.5) that the increment's error cannot exceed, in all
/// windows.
class Increments final : public EstimateSource {
 public:
  /// `options` has the convention, the windows and the match of times. Throws StudyError if the
  /// estimates are no poses, or no convention was given.
  Increments(std::unique_ptr<EstimateSource> poses, const JudgingOptions& options);

  const std::vector<std::string>& cells() const override { return labels_; }
  const std::vector<std::uint64_t>& runs() const override { return poses_->runs(); }
  std::filesystem::path place(std::size_t cell, std::size_t run) const override;
  std::filesystem::path truth_place(std::size_t cell, std::size_t run) const override {
    return poses_->truth_place(of_poses(cell), run);
  }
  /// {window} Times at which windows end.
  std::vector<double> times(std::size_t cell, std::size_t run) const override;
  /// Errors {window}{d} of a vector with the components of the pose.
  StateRows estimates(std::size_t cell, std::size_t run) const override;
  /// Not asked, since these are errors.
  StateRows truth(std::size_t cell, std::size_t run, const StateShape& shape) const override {
    return poses_->truth(of_poses(cell), run, shape);
  }
  bool has_common_truths() const override { return false; }
  bool has_errors() const override { return true; }
  TextPairs contents() const override { return poses_->contents(); }
  std::vector<std::string> notes() const override;
  /// {cell} Whether covariances are bounds.
  std::vector<bool> are_bounded() const;

 private:
  void survey_poses();
  bool is_corrected(std::size_t estimator) const;
  std::size_t of_poses(std::size_t cell) const { return cell / windows_.size(); }

  std::unique_ptr<EstimateSource> poses_;
  ErrorConvention convention_;
  TimeMatch match_;
  std::vector<double> windows_;   ///< [s]
  std::vector<bool> is_bounded_;  ///< {estimator}
  std::vector<std::string> labels_;
  mutable TruthUse use_;               ///< notes on truths as they are read
  std::vector<std::string> mistakes_;  ///< notes on the poses
};

}  // namespace montecarta::experiments
