// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/reference/fast_slam.hpp"
#include "tests/filters/reference/sigma_points.hpp"

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

/// SRCD-FastSLAM (EQUATIONS 8) as printed and corrected: seven dimensions, fifteen points, and
/// square roots alone from scan to scan. Covariances are formed for those who only look.
class SrcdFastSlam : public FastSlam2 {
 public:
  SrcdFastSlam(const FastSlamSettings& settings, Weight weight, const SrcdParts& parts)
      : FastSlam2(settings, weight), parts_(parts) {}

 protected:
  void move_gaussian(Particle& p, const Control& control, double duration) const override {
    if (!parts_.pose) return FastSlam2::move_gaussian(p, control, duration);
    Vector<7> x = Vector<7>::Zero();
    x.head<3>() = p.pose;
    const auto S =
        blocks<3, 2, 2>(tria_in<3>(heading_first(), p.factor), Q_.cwiseSqrt(), R_.cwiseSqrt());
    const auto image = central_differences<3, 2>(
        x, S, parts_.h, MotionModel{control, duration, settings_.belief.vehicle});
    Eigen::Matrix<double, 3, 14> columns;
    columns << image.A, image.B;
    p.pose = image.mean;
    keep(p, tria<3, 14>(columns));
  }

  std::optional<double> update_with(Particle& p, const Landmark& landmark,
                                    const Detection& detection) const override {
    if (!parts_.pose) return FastSlam2::update_with(p, landmark, detection);
    if (!is_far_enough(p.pose, landmark)) return std::nullopt;
    const Eigen::Matrix2d map = factor_of(landmark);
    const Differences<7, 2> whole = observation(p, landmark, map);
    const Differences<7, 2> image =
        parts_.map_uncertainty ? whole : observation(p, landmark, Eigen::Matrix2d::Zero());
    const Eigen::Matrix3d S =
        tria_in<3>(across_first_with_heading(p.pose, landmark.mean), p.factor);
    const Matrix32 K = gain<3, 2>(S * image.A.leftCols<3>().transpose(), innovation_factor(image));
    Eigen::Matrix<double, 3, 14> columns;
    columns << S - K * image.A.leftCols<3>(), K * image.A.rightCols<4>(), K * image.B;
    p.pose += K * innovation(detection, image.mean);
    p.pose(2) = wrap(p.pose(2));
    keep(p, tria<3, 14>(columns));
    const Eigen::Matrix2d S_y = innovation_factor(whole);
    return log_gaussian<2>(innovation(detection, whole.mean), S_y * S_y.transpose());
  }

  std::optional<double> log_likelihood(const Eigen::Vector3d& pose, const Landmark& landmark,
                                       const Detection& detection) const override {
    if (!parts_.map) return FastSlam2::log_likelihood(pose, landmark, detection);
    if (!is_far_enough(pose, landmark)) return std::nullopt;
    const PredictedDetection seen = predicted_from(pose, landmark);
    return log_gaussian<2>(innovation(detection, seen.image.mean), seen.S_y * seen.S_y.transpose());
  }

  void update_map(const Eigen::Vector3d& pose, Landmark& landmark,
                  const Detection& detection) const override {
    if (!parts_.map) return FastSlam2::update_map(pose, landmark, detection);
    if (!is_far_enough(pose, landmark)) return;
    const PredictedDetection seen = predicted_from(pose, landmark);
    const Eigen::Matrix2d K = gain<2, 2>(seen.S * seen.image.A.transpose(), seen.S_y);
    Eigen::Matrix<double, 2, 6> columns;
    columns << seen.S - K * seen.image.A, K * R_.cwiseSqrt(), K * seen.image.B;
    landmark.mean += K * innovation(detection, seen.image.mean);
    keep(landmark, tria<2, 6>(columns));
  }

  Landmark initialised(const Eigen::Vector3d& pose, const Detection& detection) const override {
    if (!parts_.map) return FastSlam2::initialised(pose, detection);
    const Eigen::Matrix2d root = R_.cwiseSqrt();
    const Vector<2> z(detection[0], detection[1]);
    const auto image = central_differences<2, -1>(z, root, parts_.h, PlaceModel{as_pose(pose)});
    Eigen::Matrix<double, 2, 4> columns;
    columns << image.A, image.B;
    Landmark landmark{.mean = image.mean, .covariance = {}};
    keep(landmark, tria<2, 4>(columns));
    return landmark;
  }

 private:
  /// What a landmark looks like from a pose that is taken for exact.
  struct PredictedDetection {
    Eigen::Matrix2d S;
    Differences<2, 2> image;
    Eigen::Matrix2d S_y;
  };

  Differences<7, 2> observation(const Particle& p, const Landmark& landmark,
                                const Eigen::Matrix2d& map) const {
    Vector<7> x = Vector<7>::Zero();
    x.head<3>() = p.pose;
    x.segment<2>(3) = landmark.mean;
    const auto S =
        blocks<3, 2, 2>(tria_in<3>(across_first_with_heading(p.pose, landmark.mean), p.factor),
                        tria_in<2>(across_first(p.pose, landmark.mean), map), R_.cwiseSqrt());
    return central_differences<2, 1>(x, S, parts_.h, ObservationModel{});
  }

  PredictedDetection predicted_from(const Eigen::Vector3d& pose, const Landmark& landmark) const {
    PredictedDetection seen;
    seen.S = tria_in<2>(across_first(pose, landmark.mean), factor_of(landmark));
    seen.image =
        central_differences<2, 1>(landmark.mean, seen.S, parts_.h, LandmarkModel{as_pose(pose)});
    Eigen::Matrix<double, 2, 6> columns;
    columns << seen.image.A, seen.image.B, R_.cwiseSqrt();
    seen.S_y = tria<2, 6>(columns);
    return seen;
  }

  static Eigen::Matrix2d innovation_factor(const Differences<7, 2>& image) {
    Eigen::Matrix<double, 2, 14> columns;
    columns << image.A, image.B;
    return tria<2, 14>(columns);
  }
  static Vector<2> innovation(const Detection& detection, const Vector<2>& mean) {
    return difference<1, 2>(Vector<2>(detection[0], detection[1]), mean);
  }
  /// A landmark that FastSLAM II keeps has no factor of its own.
  Eigen::Matrix2d factor_of(const Landmark& landmark) const {
    return parts_.map ? landmark.factor : psd_chol<2>(landmark.covariance);
  }
  template <class Kept, class Factor>
  static void keep(Kept& kept, const Factor& S) {
    kept.factor = S;
    kept.covariance = S * S.transpose();
  }

  SrcdParts parts_;
};

}  // namespace montecarta::filters::reference
