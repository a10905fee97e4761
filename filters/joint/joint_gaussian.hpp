// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "engine/numbers/angle.hpp"
#include "filters/joint/map_moments.hpp"
#include "filters/joint/retraction.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "filters/moments/motion_increment.hpp"
#include "filters/setup/filter_setup.hpp"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

namespace montecarta::filters {

using Matrix7 = Eigen::Matrix<double, 7, 7>;

/// Lower Cholesky factor L of an innovation covariance S = L L'.
struct InnovationFactor {
  double l00, l10, l11;

  double log_det() const { return 2.0 * std::log(l00 * l11); }
  Eigen::Matrix2d covariance() const {
    return Eigen::Matrix2d{{l00 * l00, l00 * l10}, {l00 * l10, l10 * l10 + l11 * l11}};
  }
  /// L^-1 v; its squared norm is D^2.
  Eigen::Vector2d whiten(const Eigen::Vector2d& v) const {
    const double first = v(0) / l00;
    return {first, (v(1) - l10 * first) / l11};
  }
};

/// Nothing where S is not positive definite or not a number.
[[nodiscard]] inline std::optional<InnovationFactor> factor(const Eigen::Matrix2d& S) {
  if (!(S(0, 0) > 0.0)) return std::nullopt;
  const double l00 = std::sqrt(S(0, 0));
  const double l10 = S(1, 0) / l00;
  const double pivot = S(1, 1) - l10 * l10;
  if (!(pivot > 0.0)) return std::nullopt;
  return InnovationFactor{l00, l10, std::sqrt(pivot)};
}

/// log N(v; S) of an innovation of so many dimensions with squared norm D^2 (EQUATIONS (0.1)).
inline double log_normal_density(double squared_distance, const InnovationFactor& L,
                                 double dimension) {
  return -0.5 * (squared_distance + L.log_det()) - 0.5 * dimension * std::log(kTwoPi);
}

/// A detection that is expected of a landmark, linearised: innovation v and its covariance S = H P
/// H' + R. A component that the sensor does not have is 0 in v and H, 1 in R.
struct ExpectedObservation {
  Matrix23 pose_jacobian;
  Eigen::Matrix2d landmark_jacobian;
  Eigen::Vector2d observation;  ///< at the point of linearisation
  InnovationFactor factor;      ///< of S
  /// H times the step from the estimate to the point of linearisation; not wrapped
  Eigen::Vector2d ahead = Eigen::Vector2d::Zero();
  Wraps wraps = {false, true};  ///< of the sensor

  /// v, with angles by the shorter way at the point of linearisation.
  Eigen::Vector2d innovation(const Eigen::Vector2d& detected) const {
    return models::residual(detected, observation, wraps) + ahead;
  }
};

/// A motion from the present pose, linearised there or elsewhere.
struct LinearisedMotion {
  Pose mean;                   ///< of the pose after it
  Eigen::Vector2d by_heading;  ///< [m/rad] derivative of the place by the heading before it
  Eigen::Matrix3d noise;       ///< what it adds to the covariance
};

/// Where an observation is linearised.
struct ObservationPoint {
  Pose pose;
  Eigen::Vector2d landmark;  ///< [m]
};

/// A point for the map, linear in the pose, in some points of the map, and in noise of its own.
struct NewPoint {
  struct Part {
    std::size_t slot;
    Eigen::Matrix2d derivative;
  };
  Eigen::Vector2d mean;            ///< [m]
  Matrix23 by_pose;                ///< derivative by the pose
  Eigen::Matrix2d noise;           ///< [m^2] covariance of what comes from that noise
  std::span<Part> by_points = {};  ///< derivatives by points of the map
};

/// One Gaussian over the pose and all landmarks: the state of EKF-SLAM (EQUATIONS 15). Its
/// covariance is kept in three parts, [pose cross'; cross map]. Landmarks are numbered in order of
/// initialisation.
///
/// The invariant error of Barrau turns pose and map together: xi = e - J p e_heading for every
/// point p, J = [0 -1; 1 0]. Held is the covariance of e, in the map frame; it is that of xi at the
/// present estimate. A prediction is then the same for both errors, since Fx carries xi unchanged.
/// A detection is not: xi keeps its covariance while the estimate steps, so that of e is carried
/// along.
class JointGaussian {
 public:
  /// `room` landmarks fit without allocation; it grows beyond.
  JointGaussian(const Belief& belief, Retraction retraction, std::size_t room);

  /// Stands exactly at `start` with an empty map.
  void start(const Pose& start);
  /// Becomes a copy of `other`; copies what is used, not what is reserved.
  void become(const JointGaussian& other);

  const Belief& belief() const { return belief_; }
  const PoseMoments& pose() const { return pose_; }
  /// `motion`, linearised at the estimate. Fx of several steps is again [1 0 a; 0 1 b; 0 0 1] with
  /// a and b their sums, so one motion for many steps is exact.
  LinearisedMotion linearised(const MotionIncrement& motion) const;
  /// The same by sigma points of the heading before it.
  LinearisedMotion regressed(const MotionIncrement& motion) const;
  /// What the pose would be after `motion`.
  PoseMoments pose_after(const LinearisedMotion& motion) const;
  PoseMoments pose_after(const MotionIncrement& motion) const;
  /// The vehicle moved by `motion`.
  void move(const LinearisedMotion& motion);
  void move(const MotionIncrement& motion) { move(linearised(motion)); }

  std::size_t landmarks() const { return n_landmarks_; }
  LandmarkEstimate landmark(std::size_t slot) const;
  PointMoments point(std::size_t slot) const;
  const MapMoments& map() const { return map_; }
  /// Takes these moments of the pose and of all its landmarks for its own.
  void replace(const PoseMoments& pose, const MapMoments& map);
  /// Leaves the pose and puts n points in the place of the map, all zero, for the caller to fill
  /// in.
  MapMoments& replace_map(std::size_t n_points);

  /// What a detection of `landmark` is weighed by; `faulty` where S is not positive definite. With
  /// derivatives at another point than the estimate where `at` names one.
  enum class Trouble { none, too_near, faulty };
  [[nodiscard]] Trouble look_at(const PointMoments& landmark, ExpectedObservation& expected,
                                const std::optional<ObservationPoint>& at = {}) const;
  [[nodiscard]] Trouble look_at(std::size_t slot, ExpectedObservation& expected) const {
    return look_at(point(slot), expected);
  }
  /// The same by sigma points of the landmark as seen from the pose: mean and slopes of the
  /// regression, S with what is not linear.
  [[nodiscard]] Trouble look_by_sigma_points(const PointMoments& landmark,
                                             ExpectedObservation& expected) const;
  /// Conditions the Gaussian on `detected`, expected as `expected`. The model is linearised
  /// again where the detection has moved the estimate to, until that settles or `iterations` times
  /// (iterated EKF, Bell and Cathey 1993; of invariant errors with the derivative of the
  /// exponential taken for one); `expected` becomes the last linearisation.
  /// Tells what ended the iterations too early, if anything: then the one before stands.
  Trouble update_with(std::size_t slot, const Eigen::Vector2d& detected, int iterations,
                      ExpectedObservation& expected);
  /// Adds a landmark of one detection that fixes it, correlated with everything the pose is
  /// correlated with. `behind` [m]: from where its place is linearised by the heading to the
  /// estimate of the vehicle's place.
  void append(const Eigen::Vector2d& detection,
              const Eigen::Vector2d& behind = Eigen::Vector2d::Zero());
  /// Adds a point.
  void append(const NewPoint& point);
  /// Puts a point in the place of another, which may be among those that it depends on.
  void replace(std::size_t slot, const NewPoint& point);
  /// Takes errors for relative to the pose from now on: that of a point p becomes e_p - e_x - J (p
  /// - x) e_heading, the pose has none.
  void centre_on_pose();
  /// Covariance of (x, y, heading) and of two points of the map.
  Matrix7 covariance_with(std::size_t first, std::size_t second) const;

 private:
  using Columns2 = Eigen::Matrix<double, Eigen::Dynamic, 2>;
  using Columns3 = Eigen::Matrix<double, Eigen::Dynamic, 3>;
  using Columns4 = Eigen::Matrix<double, Eigen::Dynamic, 4>;

  /// A step of the pose and of one landmark, and where it leads.
  struct Step {
    Eigen::Vector3d pose;
    Eigen::Vector2d landmark;
  };

  Eigen::Index rows() const { return packed(n_landmarks_); }
  void grow(std::size_t room);
  /// Fills in the factor of S = H P H' + `more` + R.
  [[nodiscard]] Trouble weigh(const PointMoments& landmark, const Eigen::Matrix2d& more,
                              ExpectedObservation& expected) const;
  Step step_of(std::size_t slot, const ExpectedObservation& expected,
               const Eigen::Vector2d& innovation) const;
  [[nodiscard]] Trouble linearise_after(const Step& step, std::size_t slot,
                                        ExpectedObservation& expected) const;
  void put(Eigen::Index row, const NewPoint& point);
  void whiten_gain(std::size_t slot, const ExpectedObservation& expected);
  void condition(const Eigen::Vector2d& white);
  Eigen::Vector2d step(const Eigen::Vector2d& white);
  bool carry_error(const Eigen::Vector2d& pose_step);
  void change_map(bool carries_error);

  Belief belief_;
  Eigen::Matrix2d observation_noise_;
  Wraps wraps_;
  Retraction retraction_;
  PoseMoments pose_;
  std::size_t n_landmarks_ = 0;
  MapMoments map_;
  Columns2 seen_;                          ///< scratch: the columns of one landmark
  Eigen::Matrix<double, 3, 2> gain_pose_;  ///< P H' L^-T, rows of the pose
  Columns4 gain_map_;          ///< the same, rows of the map, and two columns of carry_error()
  Columns3 moved_, halved_;    ///< scratch of centre_on_pose()
  Eigen::Matrix2Xd map_step_;  ///< [m] how one detection moves the landmarks
};

}  // namespace montecarta::filters
