// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/reference/fast_slam2.hpp"
#include "tests/filters/reference/sigma_models.hpp"

namespace montecarta::filters::reference {

/// U-FastSLAM (EQUATIONS 7) as printed: seven dimensions and fifteen points for motion and pose,
/// two and five for landmarks. The points' distance is that of five dimensions (EQUATIONS 7), which
/// is kappa - 2 in seven.
class UFastSlam : public FastSlam2 {
 public:
  UFastSlam(const FastSlamSettings& settings, Weight weight, const Unscented& unscented,
            bool map_uncertainty)
      : FastSlam2(settings, weight),
        two_(unscented),
        seven_(unscented),
        map_uncertainty_(map_uncertainty) {
    seven_.kappa -= 2.0;
  }

 protected:
  void move_gaussian(Particle& p, const Control& control, double duration) const override {
    Vector<7> x = Vector<7>::Zero();
    x.head<3>() = p.pose;
    const auto S =
        blocks<3, 2, 2>(chol_in<3>(heading_first(), p.covariance), Q_.cwiseSqrt(), R_.cwiseSqrt());
    const auto image =
        unscented<3, 2>(x, S, seven_, MotionModel{control, duration, settings_.belief.vehicle});
    p.pose = image.mean;
    p.covariance = image.covariance;
  }

  std::optional<double> update_with(Particle& p, const Landmark& landmark,
                                    const Detection& detection) const override {
    if (!is_far_enough(p.pose, landmark)) return std::nullopt;
    const Image<7, 2> whole = observation(p, landmark, landmark.covariance);
    const Image<7, 2> image =
        map_uncertainty_ ? whole : observation(p, landmark, Eigen::Matrix2d::Zero());
    const Matrix32 C = image.cross.topRows<3>();
    const Matrix32 K = C * image.covariance.inverse();
    p.pose += K * innovation(detection, image.mean);
    p.pose(2) = wrap(p.pose(2));
    p.covariance -= (K * image.covariance * K.transpose()).eval();
    return log_gaussian<2>(innovation(detection, whole.mean), whole.covariance);
  }

  std::optional<double> log_likelihood(const Eigen::Vector3d& pose, const Landmark& landmark,
                                       const Detection& detection) const override {
    if (!is_far_enough(pose, landmark)) return std::nullopt;
    const Image<2, 2> image = predicted_from(pose, landmark);
    return log_gaussian<2>(innovation(detection, image.mean), image.covariance);
  }

  void update_map(const Eigen::Vector3d& pose, Landmark& landmark,
                  const Detection& detection) const override {
    if (!is_far_enough(pose, landmark)) return;
    const Image<2, 2> image = predicted_from(pose, landmark);
    const Eigen::Matrix2d K = image.cross * image.covariance.inverse();
    landmark.mean += K * innovation(detection, image.mean);
    landmark.covariance -= (K * image.covariance * K.transpose()).eval();
  }

  Landmark initialised(const Eigen::Vector3d& pose, const Detection& detection) const override {
    const Eigen::Matrix2d root = R_.cwiseSqrt();
    const Vector<2> z(detection[0], detection[1]);
    const auto image = unscented<2, -1>(z, root, two_, PlaceModel{as_pose(pose)});
    return {.mean = image.mean, .covariance = image.covariance};
  }

 private:
  Image<7, 2> observation(const Particle& p, const Landmark& landmark,
                          const Eigen::Matrix2d& map_covariance) const {
    Vector<7> x = Vector<7>::Zero();
    x.head<3>() = p.pose;
    x.segment<2>(3) = landmark.mean;
    const auto S = blocks<3, 2, 2>(
        chol_in<3>(across_first_with_heading(p.pose, landmark.mean), p.covariance),
        chol_in<2>(across_first(p.pose, landmark.mean), map_covariance), R_.cwiseSqrt());
    return unscented<2, 1>(x, S, seven_, ObservationModel{});
  }

  Image<2, 2> predicted_from(const Eigen::Vector3d& pose, const Landmark& landmark) const {
    const Eigen::Matrix2d S = chol_in<2>(across_first(pose, landmark.mean), landmark.covariance);
    auto image = unscented<2, 1>(landmark.mean, S, two_, LandmarkModel{as_pose(pose)});
    image.covariance += R_;
    return image;
  }

  static Vector<2> innovation(const Detection& detection, const Vector<2>& mean) {
    return difference<1, 2>(Vector<2>(detection[0], detection[1]), mean);
  }

  Unscented two_, seven_;
  bool map_uncertainty_;
};

}  // namespace montecarta::filters::reference
