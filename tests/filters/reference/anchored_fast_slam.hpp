// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/reference/particle.hpp"

namespace montecarta::reference {

inline LinearisedPlace<double> placed(const Pose& anchor, const Eigen::Vector2d& q) {
  return linearised_place(anchor, RangeBearing<double>{q(0), q(1)});
}

/// Absorbs a detection into range and bearing q from `anchor`, seen from an exactly known pose:
/// three steps of Gauss and Newton.
inline void update_sight(Eigen::Vector2d& q, Eigen::Matrix2d& P, const Pose& anchor,
                         const Pose& pose, const Detection& detection, const Eigen::Matrix2d& R) {
  const Eigen::Vector2d before = q;
  Eigen::Matrix2d H, K;
  for (int step = 0; step < 3; ++step) {
    const auto place = placed(anchor, q);
    const auto at = linearised_sight(pose, place.point);
    H = landmark_jacobian(at) * sight_jacobian(place);
    const Eigen::Vector2d nu =
        to_vector(residual(sight_of(detection), at.sight)) + H * (q - before);
    const Eigen::Matrix2d S = H * P * H.transpose() + R;
    K = P * H.transpose() * S.inverse();
    q = before + K * nu;
  }
  P -= (K * H * P).eval();
}

/// A filter of the family whose landmarks are range and bearing from the pose of birth (SPEC 24,
/// last lines); its poses see them as the Gaussians they nearly are in the map.
template <class Filter>
class AnchoredMaps final : public Filter {
 public:
  using Filter::Filter;

 private:
  void update_map(const Eigen::Vector3d& pose, Landmark& landmark,
                  const Detection& detection) const override {
    if (!seen_from(pose, landmark, detection, this->R_)) return;
    update_sight(landmark.sight, landmark.sight_covariance, as_pose(landmark.anchor), as_pose(pose),
                 detection, this->R_);
    put_into_map(landmark);
  }
  Landmark born(const Eigen::Vector3d& pose, const Detection& detection) const override {
    Landmark landmark;
    landmark.anchor = pose;
    landmark.sight = to_vector(sight_of(detection));
    landmark.sight_covariance = this->R_;
    put_into_map(landmark);
    return landmark;
  }

  static void put_into_map(Landmark& landmark) {
    const auto place = placed(as_pose(landmark.anchor), landmark.sight);
    const Eigen::Matrix2d Gz = sight_jacobian(place);
    landmark.mean = to_vector(place.point);
    landmark.covariance = Gz * landmark.sight_covariance * Gz.transpose();
  }
};

}  // namespace montecarta::reference
