// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/retraction.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "filters/moments/motion_increment.hpp"

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

/// Returns nullopt if S is not positive definite or contains NaN.
[[nodiscard]] inline std::optional<InnovationFactor> factor(const Eigen::Matrix2d& S) {
  if (!(S(0, 0) > 0.0)) return std::nullopt;
  const double l00 = std::sqrt(S(0, 0));
  const double l10 = S(1, 0) / l00;
  const double pivot = S(1, 1) - l10 * l10;
  if (!(pivot > 0.0)) return std::nullopt;
  return InnovationFactor{l00, l10, std::sqrt(pivot)};
}

/// log N(v; S) of an innovation with the given dimension and squared norm D^2 (EQUATIONS (0.1)).
inline double log_normal_density(double squared_distance, const InnovationFactor& L,
                                 double dimension) {
  return -0.5 * (squared_distance + L.log_det()) - 0.5 * dimension * std::log(kTwoPi);
}

/// The predicted detection of a landmark, linearised: innovation v and its covariance S = H P H' +
/// R. A component that the sensor does not have is 0 in v and H, and 1 in R.
struct ExpectedObservation {
  Matrix23 pose_jacobian;
  Eigen::Matrix2d landmark_jacobian;
  Eigen::Vector2d observation;  ///< predicted at the point of linearisation
  InnovationFactor factor;      ///< Cholesky factor of S
  /// H times the step from the estimate to the point of linearisation; not wrapped.
  Eigen::Vector2d ahead = Eigen::Vector2d::Zero();
  Wraps wraps = {false, true};  ///< angles among the components

  /// v, with angles wrapped at the point of linearisation.
  Eigen::Vector2d innovation(const Eigen::Vector2d& detected) const {
    return models::residual(detected, observation, wraps) + ahead;
  }
};

/// A motion from the present pose, linearised there or at another point.
struct LinearisedMotion {
  Pose mean;  ///< pose after the motion
  /// [m/rad] derivative of the position by the heading before the motion.
  Eigen::Vector2d by_heading;
  Eigen::Matrix3d noise;  ///< covariance that the motion adds
};

/// The point at which an observation is linearised.
struct ObservationPoint {
  Pose pose;
  Eigen::Vector2d landmark;  ///< [m] position of the landmark
};

/// A new point of the map, linear in the pose, in points of the map, and in noise of its own.
struct NewPoint {
  struct Part {
    std::size_t slot;
    Eigen::Matrix2d derivative;
  };
  Eigen::Vector2d mean;            ///< [m] mean of the point
  Matrix23 by_pose;                ///< derivative by the pose
  Eigen::Matrix2d noise;           ///< [m^2] covariance due to its own noise
  std::span<Part> by_points = {};  ///< derivatives by points of the map
};

/// One Gaussian over the pose and all landmarks: the state of EKF-SLAM (EQUATIONS 15). Its
/// covariance is kept in three parts, [pose cross'; cross map]. Landmarks are numbered in order of
/// initialisation.
///
/// The right-invariant error of Barrau rotates pose and map together: xi = e - J p e_heading for
/// every point p, J = [0 -1; 1 0]. The covariance that is kept is that of e, in the map frame, and
/// it equals that of xi at the present estimate. A prediction is then the same for both errors,
/// since Fx leaves xi unchanged. A detection is not: the covariance of xi stays while the estimate
/// moves, so that the covariance of e must be transformed. The left-invariant error moves a point
/// by the same exponential, in the axes of the vehicle: with its heading the covariance of e turns.
class JointGaussian {
 public:
  /// Reserves memory for `room` landmarks, which grows if needed.
  JointGaussian(const Belief& belief, Retraction retraction, std::size_t room);

  /// Starts with the vehicle at `start` and an empty map.
  void start(const Pose& start, const Eigen::Matrix3d& covariance = Eigen::Matrix3d::Zero());

  const Belief& belief() const { return belief_; }
  const PoseMoments& pose() const { return pose_; }
  /// Returns `motion`, linearised at the estimate. Fx of several steps is again [1 0 a; 0 1 b; 0 0
  /// 1], where a and b are sums over the steps, so that one motion for many steps is exact.
  LinearisedMotion linearised(const MotionIncrement& motion) const;
  /// Returns `motion`, linearised by sigma points of the heading before it (EQUATIONS (15.14)).
  /// For an invariant error this equals linearised().
  LinearisedMotion regressed(const MotionIncrement& motion) const;
  /// Predicted moments of the pose after `motion`.
  PoseMoments pose_after(const LinearisedMotion& motion) const;
  PoseMoments pose_after(const MotionIncrement& motion) const;
  /// Predicts by `motion`.
  void move(const LinearisedMotion& motion);
  void move(const MotionIncrement& motion) { move(linearised(motion)); }

  std::size_t landmarks() const { return n_landmarks_; }
  PointMoments point(std::size_t slot) const;
  const MapMoments& map() const { return map_; }
  /// Replaces the moments of the pose and of all landmarks.
  void replace(const PoseMoments& pose, const MapMoments& map);
  /// Keeps the pose and replaces the map by `n_points` points with zero moments, for the caller to
  /// fill.
  MapMoments& replace_map(std::size_t n_points);

  /// Predicts the detection of `landmark`; `faulty` means that S is not positive definite. The
  /// derivatives are those at `at` if it is given, else at the estimate.
  enum class ObservationStatus { usable, too_near, faulty };
  [[nodiscard]] ObservationStatus predict_observation(
      const PointMoments& landmark, ExpectedObservation& expected,
      const std::optional<ObservationPoint>& at = {}) const;
  [[nodiscard]] ObservationStatus predict_observation(std::size_t slot,
                                                      ExpectedObservation& expected) const {
    return predict_observation(point(slot), expected);
  }
  /// Predicts the detection of `landmark` by sigma points of its position relative to the pose
  /// (EQUATIONS (15.13)): mean and slopes of the regression, and S with the nonlinear part.
  [[nodiscard]] ObservationStatus predict_by_sigma_points(const PointMoments& landmark,
                                                          ExpectedObservation& expected) const;
  /// Conditions the Gaussian on `detected`, which is predicted by `expected`. The model is
  /// linearised again at the updated estimate until it converges, at most `iterations` times
  /// (iterated EKF, Bell and Cathey 1993; for invariant errors the derivative of the exponential is
  /// approximated by one). `expected` becomes the last linearisation. Returns the status that
  /// ended the iterations too early, if any; the linearisation before it is then used.
  ObservationStatus update_with(std::size_t slot, const Eigen::Vector2d& detected, int iterations,
                                ExpectedObservation& expected);
  /// Conditions the Gaussian on a fix of the position of the vehicle with this standard deviation
  /// [m] (EQUATIONS (24.1)). `log_density` becomes the log of the density of its innovation.
  /// Nothing changes if S is not positive definite (`faulty`).
  [[nodiscard]] ObservationStatus update_with_fix(const PositionFix& fix, double sigma,
                                                  double& log_density);
  /// Adds a landmark from one detection that fixes it, with its correlations. `behind` [m] is the
  /// vector to the estimated position of the vehicle from the point at which the landmark is
  /// linearised by the heading.
  void append(const Eigen::Vector2d& detection,
              const Eigen::Vector2d& behind = Eigen::Vector2d::Zero());
  /// Adds a point.
  void append(const NewPoint& point);
  /// Replaces a point by another, which may depend on it.
  void replace(std::size_t slot, const NewPoint& point);
  /// Changes the errors to errors relative to the pose: the error of a point p becomes e_p - e_x -
  /// J (p - x) e_heading, and that of the pose becomes zero (EQUATIONS (15.16)).
  void centre_on_pose();
  /// Covariance of (x, y, heading) and two points of the map.
  Matrix7 covariance_with(std::size_t first, std::size_t second) const;

 private:
  using Columns2 = Eigen::Matrix<double, Eigen::Dynamic, 2>;
  using Columns3 = Eigen::Matrix<double, Eigen::Dynamic, 3>;
  using Columns4 = Eigen::Matrix<double, Eigen::Dynamic, 4>;

  /// A step of the pose and of one landmark.
  struct Step {
    Eigen::Vector3d pose;
    Eigen::Vector2d landmark;
  };

  Eigen::Index rows() const { return packed(n_landmarks_); }
  void grow(std::size_t room);
  /// Computes the factor of S = H P H' + `more` + R.
  [[nodiscard]] ObservationStatus weigh(const PointMoments& landmark, const Eigen::Matrix2d& more,
                                        ExpectedObservation& expected) const;
  Step step_of(std::size_t slot, const ExpectedObservation& expected,
               const Eigen::Vector2d& innovation) const;
  [[nodiscard]] ObservationStatus linearise_after(const Step& step, std::size_t slot,
                                                  ExpectedObservation& expected) const;
  void put(Eigen::Index row, const NewPoint& point);
  void whiten_gain(std::size_t slot, const ExpectedObservation& expected);
  void condition(const Eigen::Vector2d& white);
  Eigen::Vector2d step(const Eigen::Vector2d& white);
  bool carry_error(const Eigen::Vector2d& pose_step);
  void turn_error(double angle);
  void change_map(bool carries_error);

  Belief belief_;
  Eigen::Matrix2d observation_noise_;
  Wraps wraps_;
  Retraction retraction_;
  PoseMoments pose_;
  std::size_t n_landmarks_ = 0;
  MapMoments map_;
  Columns2 seen_;                          ///< scratch: columns of one landmark
  Eigen::Matrix<double, 3, 2> gain_pose_;  ///< P H' L^-T, the rows of the pose
  Columns4 gain_map_;          ///< P H' L^-T, the rows of the map, and columns of carry_error()
  Columns3 moved_, halved_;    ///< scratch of centre_on_pose()
  Eigen::Matrix2Xd map_step_;  ///< [m] step of the landmarks at one detection
};

}  // namespace montecarta::filters
