// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/increments.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "experiments/judging/difference_bound.hpp"
#include "experiments/judging/error_convention.hpp"
#include "experiments/judging/run_files.hpp"
#include "experiments/text/words.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <utility>

namespace montecarta::experiments {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// A pose in space; that in the plane has no height.
Eigen::Isometry3d pose_of(const StateShape& shape, const Eigen::VectorXd& state) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (shape.kind == StateKind::pose) {
    pose.translation() << state(0), state(1), 0.0;
    pose.linear() = Eigen::AngleAxisd(state(2), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return pose;
  }
  pose.translation() = state.head<3>();
  pose.linear() = quaternion_in(state).toRotationMatrix();
  return pose;
}

/// The pose of the map, seen from `pose`.
Eigen::Isometry3d reversed(const Eigen::Isometry3d& pose) {
  Eigen::Isometry3d found = Eigen::Isometry3d::Identity();
  found.linear() = pose.linear().transpose();
  found.translation() = -(found.linear() * pose.translation());
  return found;
}

/// The components of a pose among x, y, z, rx, ry, rz.
std::vector<Eigen::Index> components_in_space(const StateShape& shape) {
  if (shape.kind == StateKind::pose) return {0, 1, 5};
  return {0, 1, 2, 3, 4, 5};
}

/// The matrix by which a small motion in the frame of `pose` becomes one in the map.
Matrix6 adjoint(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d p = pose.translation();
  const Eigen::Matrix3d cross{{0.0, -p.z(), p.y()}, {p.z(), 0.0, -p.x()}, {-p.y(), p.x(), 0.0}};
  Matrix6 found = Matrix6::Zero();
  found.topLeftCorner<3, 3>() = found.bottomRightCorner<3, 3>() = pose.linear();
  found.topRightCorner<3, 3>() = cross * pose.linear();
  return found;
}

/// The matrix by which the error of a convention becomes that in the body, to first order.
Matrix6 to_body(ErrorConvention convention, const Eigen::Isometry3d& mean) {
  if (convention == ErrorConvention::right_invariant) return adjoint(reversed(mean));
  Matrix6 found = Matrix6::Identity();
  if (convention == ErrorConvention::body || convention == ErrorConvention::left_invariant)
    return found;
  found.topLeftCorner<3, 3>() = mean.linear().transpose();
  if (convention == ErrorConvention::world)
    found.bottomRightCorner<3, 3>() = mean.linear().transpose();
  return found;
}

/// The covariance {6, 6} of a pose in the body; of a pose in the plane the rest is 0.
Matrix6 covariance_in_body(const StateRows& rows, std::size_t row, ErrorConvention convention) {
  const auto places = components_in_space(rows.shape);
  const auto d = static_cast<Eigen::Index>(places.size());
  Matrix6 P = Matrix6::Zero();
  P(places, places) = rows.covariance[row].topLeftCorner(d, d);
  const Matrix6 turn = to_body(convention, pose_of(rows.shape, rows.state[row]));
  return turn * P * turn.transpose();
}

/// The state (position and quaternion) of a pose in space.
Eigen::VectorXd state_of(const Eigen::Isometry3d& pose) {
  Eigen::VectorXd state(kPoseWidth);
  state << pose.translation(), Eigen::Quaterniond(pose.linear()).coeffs();
  return state;
}

/// The errors of a pose's components, as a vector.
StateShape shape_of_increments(const StateShape& poses) {
  const auto d = static_cast<std::ptrdiff_t>(components_in_space(poses).size());
  StateShape shape;
  shape.components.assign(poses.components.begin(), poses.components.begin() + d);
  shape.units.assign(poses.units.begin(), poses.units.begin() + d);
  shape.columns = shape.components;
  return shape;
}

/// Which covariance an increment has.
enum class IncrementCovariance : std::uint8_t {
  added,  ///< that at its end without that at its start (STATISTICS (19.6))
  bound   ///< what its error cannot exceed (19.5)
};

/// Adds the error and covariance of the increment from row `from` to row `to`.
void add_increment(const StateRows& poses, const std::vector<std::optional<TrueState>>& truths,
                   std::size_t from, std::size_t to, ErrorConvention convention,
                   IncrementCovariance kind, StateRows& increments) {
  static const StateShape space = {.kind = StateKind::pose_in_space,
                                   .columns = std::vector<std::string>(kPoseWidth),
                                   .components = std::vector<std::string>(kPoseComponents),
                                   .units = {}};
  const auto pose = [&](const Eigen::VectorXd& state) { return pose_of(poses.shape, state); };
  const Eigen::Isometry3d mean = reversed(pose(poses.state[from])) * pose(poses.state[to]);
  const Eigen::Isometry3d truth = reversed(pose(truths[from]->state)) * pose(truths[to]->state);
  const Eigen::VectorXd error =
      error_of(space, ErrorConvention::body, state_of(mean), state_of(truth));
  const Matrix6 carried = adjoint(reversed(mean));
  const auto places = components_in_space(poses.shape);
  const auto judged_part = [&](const Matrix6& P) { return Eigen::MatrixXd(P(places, places)); };
  const Eigen::MatrixXd end = judged_part(covariance_in_body(poses, to, convention));
  const Eigen::MatrixXd start =
      judged_part(carried * covariance_in_body(poses, from, convention) * carried.transpose());
  const Eigen::MatrixXd judged = kind == IncrementCovariance::added
                                     ? Eigen::MatrixXd(end - start)
                                     : largest_covariance_of_difference(end, start);
  increments.time.push_back(poses.time[to]);
  increments.line.push_back(poses.line[to]);
  increments.state.emplace_back(error(places));
  increments.covariance.emplace_back(0.5 * (judged + judged.transpose()));
}

/// Increments over windows that follow each other; a window with a gap of the estimates or of their
/// truth is left out.
StateRows increments_of(const StateRows& poses, const std::vector<std::optional<TrueState>>& truths,
                        double window, ErrorConvention convention, IncrementCovariance kind) {
  constexpr double kRounding = 1e-6, kLongest = 1.5;  // [s], in windows
  StateRows increments{.shape = shape_of_increments(poses.shape)};
  std::optional<std::size_t> from;
  for (std::size_t row = 0; row < poses.time.size(); ++row) {
    if (!truths[row]) continue;
    const double elapsed = from ? poses.time[row] - poses.time[*from] : 0.0;
    if (from && elapsed < window - kRounding) continue;
    if (from && elapsed <= kLongest * window)
      add_increment(poses, truths, *from, row, convention, kind, increments);
    from = row;
  }
  return increments;
}

}  // namespace

Increments::Increments(std::unique_ptr<EstimateSource> poses, const JudgingOptions& options)
    : poses_(std::move(poses)), match_(options.match), windows_(options.windows) {
  const StateShape shape = poses_->estimates(0, 0).shape;
  if (poses_->has_errors() || shape.kind == StateKind::vector) {
    throw StudyError(poses_->place(0, 0).string() +
                     ": --windows is for poses (increments of others have no frame): leave it out");
  }
  convention_ = stated_error(shape, poses_->place(0, 0), options.convention);
  for (const std::string& label : poses_->cells()) {
    for (const double window : windows_) {
      labels_.push_back(formatted("{}.{}s", label, to_text(window)));
      check_label(labels_.back());
    }
  }
  survey_poses();
  is_bounded_.assign(poses_->cells().size(), false);
  for (std::size_t k = 0; k < is_bounded_.size(); ++k) is_bounded_[k] = is_corrected(k);
}

/// Throws StudyError if poses or truths have other units than their columns say. Notes on them.
void Increments::survey_poses() {
  LikelyMistakes mistakes(poses_->cells(), convention_, false, false);
  for (std::size_t run = 0; run < runs().size(); ++run) {
    for (std::size_t k = 0; k < poses_->cells().size(); ++k) {
      const std::filesystem::path path = poses_->place(k, run);
      const StateRows rows = poses_->estimates(k, run);
      const StateRows truth = poses_->truth(k, run, rows.shape);
      mistakes.add_truth(truth, poses_->truth_place(k, run));
      mistakes.add(k, rows, path, truth);
    }
  }
  mistakes_ = mistakes.notes();
}

/// Whether more than a few increments of an estimator have no covariance that was added: then its
/// estimates were corrected after their start.
bool Increments::is_corrected(std::size_t estimator) const {
  constexpr double kMostShare = 0.01;
  double all = 0.0, without = 0.0;
  for (std::size_t window = 0; window < windows_.size(); ++window) {
    const std::size_t cell = estimator * windows_.size() + window;
    for (std::size_t run = 0; run < runs().size(); ++run) {
      for (const Eigen::MatrixXd& P : estimates(cell, run).covariance) {
        all += 1.0;
        without += is_covariance(P) ? 0.0 : 1.0;
      }
    }
  }
  return without > kMostShare * all;
}

std::vector<bool> Increments::are_bounded() const {
  std::vector<bool> all;
  for (std::size_t cell = 0; cell < labels_.size(); ++cell)
    all.push_back(is_bounded_[of_poses(cell)]);
  return all;
}

std::filesystem::path Increments::place(std::size_t cell, std::size_t run) const {
  return poses_->place(of_poses(cell), run);
}

std::vector<double> Increments::times(std::size_t cell, std::size_t run) const {
  return estimates(cell, run).time;
}

StateRows Increments::estimates(std::size_t cell, std::size_t run) const {
  const StateRows poses = poses_->estimates(of_poses(cell), run);
  const TruthPath truth(poses_->truth(of_poses(cell), run, poses.shape), truth_place(cell, run),
                        match_);
  use_ = {};  // what is said of one file is said of its last reading
  return increments_of(
      poses, truth.at(poses, place(cell, run), use_), windows_[cell % windows_.size()], convention_,
      is_bounded_[of_poses(cell)] ? IncrementCovariance::bound : IncrementCovariance::added);
}

std::vector<std::string> Increments::notes() const {
  std::vector<std::string> notes = poses_->notes();
  const std::vector<std::string> of_truth = use_.notes(false);
  notes.insert(notes.end(), of_truth.begin(), of_truth.end());
  notes.insert(notes.end(), mistakes_.begin(), mistakes_.end());
  return notes;
}

}  // namespace montecarta::experiments
