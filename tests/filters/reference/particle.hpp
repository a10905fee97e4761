// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"
#include "filters/association/nearest.hpp"
#include "filters/models/eigen_jacobians.hpp"

#include <Eigen/Dense>

#include <optional>
#include <vector>

namespace montecarta::filters::reference {

struct Landmark {
  Eigen::Vector2d mean;
  Eigen::Matrix2d covariance;
  Eigen::Matrix2d factor = Eigen::Matrix2d::Zero();  ///< where the filter keeps square roots
};

/// One particle of the FastSLAM family (EQUATIONS 4), with its own map and its own opinion on the
/// scan.
struct Particle {
  Eigen::Vector3d pose = Eigen::Vector3d::Zero();        ///< x_i; drawn after a scan
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< P_i, accumulated since the last draw
  Eigen::Matrix3d factor = Eigen::Matrix3d::Zero();      ///< where the filter keeps square roots
  Eigen::Vector3d refined_pose =
      Eigen::Vector3d::Zero();  ///< proposal of the last scan, before drawing
  Eigen::Matrix3d refined_covariance = Eigen::Matrix3d::Zero();
  double log_weight = 0.0;
  std::uint32_t ancestor = 0;                ///< index one scan ago
  std::vector<std::optional<Landmark>> map;  ///< by identity where known, else by initialisation
  std::vector<Pairing> pairings;             ///< one per detection
};

inline Pose as_pose(const Eigen::Vector3d& x) { return {x(0), x(1), x(2)}; }
inline Eigen::Vector3d to_vector(const Pose& pose) { return {pose.x, pose.y, pose.heading}; }

/// A landmark seen from a pose: everything EQUATIONS 6 derives from h.
struct Seen {
  Matrix23 Hx;
  Eigen::Matrix2d Hf;
  Eigen::Matrix2d S_f;  ///< Hf Sigma Hf' + R
  Eigen::Vector2d nu;   ///< innovation, bearing wrapped
};

/// Nothing where the landmark is too near (EQUATIONS 2).
inline std::optional<Seen> seen_from(const Eigen::Vector3d& pose, const Landmark& landmark,
                                     const Detection& detection, const Eigen::Matrix2d& R) {
  const auto at = linearised_observation(as_pose(pose), Point{landmark.mean(0), landmark.mean(1)});
  if (too_near(at.observation)) return std::nullopt;
  const Eigen::Matrix2d Hf = landmark_jacobian(at);
  return Seen{pose_jacobian(at), Hf, Hf * landmark.covariance * Hf.transpose() + R,
              to_vector(residual(observation_of(detection), at.observation))};
}

/// Feature EKF at an exactly known pose, Joseph form (EQUATIONS 4).
inline void update_landmark(Landmark& landmark, const Seen& seen, const Eigen::Matrix2d& R) {
  const Eigen::Matrix2d K = landmark.covariance * seen.Hf.transpose() * seen.S_f.inverse();
  const Eigen::Matrix2d I_KH = Eigen::Matrix2d::Identity() - K * seen.Hf;
  landmark.mean += K * seen.nu;
  landmark.covariance =
      (I_KH * landmark.covariance * I_KH.transpose() + K * R * K.transpose()).eval();
}

/// mu = g(x, z), Sigma = Gz R Gz' (EQUATIONS 4).
inline Landmark new_landmark(const Eigen::Vector3d& pose, const Detection& detection,
                             const Eigen::Matrix2d& R) {
  const auto placed = linearised_place(as_pose(pose), observation_of(detection));
  const Eigen::Matrix2d Gz = observation_jacobian(placed);
  return {.mean = to_vector(placed.point), .covariance = Gz * R * Gz.transpose()};
}

}  // namespace montecarta::filters::reference
