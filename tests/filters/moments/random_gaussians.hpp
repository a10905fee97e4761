// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/stream.hpp"
#include "filters/moments/evidence.hpp"
#include "filters/moments/gaussians.hpp"

#include <Eigen/Core>

#include <cmath>

/// Random beliefs for tests of the moment transforms.
namespace montecarta::filters {

/// Covariance over (x, y, heading) of up to `place` [m] and `heading` [rad], correlated.
inline Symmetric3<double> random_pose_covariance(RngStream& draw, double place, double heading) {
  Eigen::Matrix3d S;
  for (double& value : S.reshaped()) value = draw.normal();
  S.topRows<2>() *= place, S.row(2) *= heading;
  return symmetric_of(S * S.transpose());
}

inline Symmetric2<double> random_landmark_covariance(RngStream& draw, double place) {
  Eigen::Matrix2d S;
  for (double& value : S.reshaped()) value = place * draw.normal();
  const Eigen::Matrix2d P = S * S.transpose();
  return {P(0, 0), P(0, 1), P(1, 1)};
}

inline Eigen::Matrix2d symmetric(const Symmetric2<double>& P) {
  return Eigen::Matrix2d{{P.xx, P.xy}, {P.xy, P.yy}};
}

inline Eigen::Vector2d to_vector(const Measurement<double>& seen) {
  return {seen.first, seen.second};
}

/// A pose, a landmark 15 to 35 m away, and a detection of it.
struct RandomObservation {
  PoseGaussian<double> pose;
  LandmarkGaussian<double> landmark;
  Measurement<double> seen;
  SensorNoise noise;

  /// `scale` = 1: uncertain enough to be bent; small: as good as linear.
  explicit RandomObservation(RngStream& draw, double scale = 1.0) {
    pose.mean = {10.0 * draw.normal(), 10.0 * draw.normal(), wrap(7.0 * draw.normal())};
    pose.covariance = random_pose_covariance(draw, 0.5 * scale, 0.05 * scale);
    const double angle = 7.0 * draw.normal(), range = 15.0 + 20.0 * draw.uniform();
    landmark.mean = {pose.mean.x + range * std::cos(angle), pose.mean.y + range * std::sin(angle)};
    landmark.covariance = random_landmark_covariance(draw, 0.8 * scale);
    noise = {std::pow(scale * (0.05 + draw.uniform()), 2),
             std::pow(0.1 * scale * (0.05 + draw.uniform()), 2)};
    const RangeBearing<double> observation = predicted_observation(pose.mean, landmark.mean);
    seen = {observation.range + scale * draw.normal(),
            wrap(observation.bearing + 0.05 * scale * draw.normal())};
  }
};

}  // namespace montecarta::filters
