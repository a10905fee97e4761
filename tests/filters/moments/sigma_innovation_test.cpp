// SPDX-License-Identifier: BSD-3-Clause
// What the filters compute as covariance of an innovation, against the papers' formulas.
#include "filters/moments/moment_transforms.hpp"
#include "tests/filters/moments/random_gaussians.hpp"
#include "tests/filters/reference/sigma_models.hpp"
#include "tests/filters/reference/square_root.hpp"

#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

using reference::Vector;

const double kInterval = std::sqrt(3.0);

Eigen::Matrix2d covariance_of(const Innovation<double>& v) {
  return Eigen::Matrix2d{{v.S.xx, v.S.xy}, {v.S.xy, v.S.yy}};
}
/// P_xz, the columns by range and by bearing.
Matrix32 cross_of(const Innovation<double>& v) {
  Matrix32 C;
  C << v.range.x, v.bearing.x, v.range.y, v.bearing.y, v.range.h, v.bearing.h;
  return C;
}
Eigen::Matrix2d root_of(const SensorNoise& noise) {
  return Vector<2>(std::sqrt(noise.range), std::sqrt(noise.bearing)).asDiagonal();
}
Eigen::Matrix2d root_of(const RandomObservation& c) {
  const Vector<3> pose = reference::to_vector(c.pose.mean);
  return reference::chol_in<2>(reference::across_first(pose, to_vector(c.landmark.mean)),
                               symmetric(c.landmark.covariance));
}

/// `v` has the moments of `image`, of ranges up to 35 m but for their rounding.
template <int N>
void expect_moments(const Innovation<double>& v, const RandomObservation& c,
                    const reference::Differences<N, 2>& image) {
  const Eigen::Matrix2d S = image.A * image.A.transpose() + image.B * image.B.transpose();
  const Vector<2> nu = reference::difference<1, 2>(to_vector(c.seen), image.mean);
  EXPECT_LT((covariance_of(v) - S).norm(), 1e-13 * (1 + S.norm()));
  EXPECT_LT((to_vector(v.value) - nu).norm(), 1e-13 * (1 + nu.norm()));
}

TEST(SigmaInnovation, OfALandmarkAddsTheNoiseThatPointsWouldCarry) {
  RngStream draw({.seed = 233, .purpose = Draw::test});
  for (int n = 0; n < 500; ++n) {
    const RandomObservation c(draw);
    Vector<4> both = Vector<4>::Zero();
    both.head<2>() = to_vector(c.landmark.mean);
    Eigen::Matrix4d root = Eigen::Matrix4d::Zero();
    root.topLeftCorner<2, 2>() = root_of(c), root.bottomRightCorner<2, 2>() = root_of(c.noise);
    const reference::LandmarkModel observation{c.pose.mean};
    const auto augmented = reference::central_differences<2, 1>(
        both, root, kInterval,
        [&](const Vector<4>& v) -> Vector<2> { return observation(v.head<2>()) + v.tail<2>(); });

    LandmarkGaussian<double> landmark = c.landmark;
    Evidence<double> evidence;
    const auto v =
        update_landmark_by_sigma_points(landmark, c.pose.mean, c.seen, c.noise, Everywhere(),
                                        evidence, central_difference_rule(kInterval));
    expect_moments<4>(v, c, augmented);
  }
}

TEST(SigmaInnovation, OfAPoseAddsTheNoiseThatPointsWouldCarry) {
  RngStream draw({.seed = 234, .purpose = Draw::test});
  for (int n = 0; n < 500; ++n) {
    const RandomObservation c(draw);
    Vector<7> all = Vector<7>::Zero();
    all.head<3>() = reference::to_vector(c.pose.mean);
    all.segment<2>(3) = to_vector(c.landmark.mean);
    const Eigen::Matrix3d T =
        reference::across_first_with_heading(all.head<3>(), all.segment<2>(3));
    const auto root = reference::blocks<3, 2, 2>(
        reference::chol_in<3>(T, symmetric(c.pose.covariance)), root_of(c), root_of(c.noise));
    const auto augmented =
        reference::central_differences<2, 1>(all, root, kInterval, reference::ObservationModel{});

    const LineOfSight<double> s = line_of_sight(c.pose.mean, c.landmark.mean);
    const auto observation =
        sigma_observation_of(c.pose.covariance, c.landmark.covariance, s, c.seen, c.noise,
                             central_difference_rule(kInterval), MapUncertainty::on);
    expect_moments<7>(observation.whole, c, augmented);
    const Matrix32 C = (root * augmented.A.transpose()).topRows<3>();
    EXPECT_LT((cross_of(observation.proposal) - C).norm(), 1e-13 * (1 + C.norm()));
  }
}

/// Hx P Hx' + Hf Sigma Hf' + R and its parts, with the models' derivatives.
struct LinearObservation {
  Eigen::Matrix2d of_pose, of_map, of_sensor;
  Matrix32 cross;
  explicit LinearObservation(const RandomObservation& c) {
    const auto observation = linearised_observation(c.pose.mean, c.landmark.mean);
    const Matrix23 Hx = pose_jacobian(observation);
    const Eigen::Matrix2d Hf = landmark_jacobian(observation);
    const Eigen::Matrix3d P = symmetric(c.pose.covariance);
    of_pose = Hx * P * Hx.transpose();
    of_map = Hf * symmetric(c.landmark.covariance) * Hf.transpose();
    of_sensor = Vector<2>(c.noise.range, c.noise.bearing).asDiagonal();
    cross = P * Hx.transpose();
  }
  Eigen::Matrix2d whole() const { return of_pose + of_map + of_sensor; }
};

TEST(SigmaInnovation, IsThatOfPoseMapAndSensorOnLinearModels) {
  RngStream draw({.seed = 236, .purpose = Draw::test});
  for (int n = 0; n < 500; ++n) {
    const RandomObservation c(draw, 1e-4);
    const LinearObservation truth(c);
    const LineOfSight<double> s = line_of_sight(c.pose.mean, c.landmark.mean);
    for (const SigmaRule& rule :
         {unscented_rule(5, 0.9, 2, 0), central_difference_rule(kInterval)}) {
      for (const auto map : {MapUncertainty::on, MapUncertainty::off}) {
        const auto observation = sigma_observation_of(c.pose.covariance, c.landmark.covariance, s,
                                                      c.seen, c.noise, rule, map);
        const Eigen::Matrix2d moving =
            map == MapUncertainty::on ? truth.whole() : truth.of_pose + truth.of_sensor;
        EXPECT_LT((covariance_of(observation.whole) - truth.whole()).norm(),
                  1e-7 * truth.whole().norm());
        EXPECT_LT((covariance_of(observation.proposal) - moving).norm(), 1e-7 * moving.norm());
        EXPECT_LT((cross_of(observation.proposal) - truth.cross).norm(), 1e-7 * truth.cross.norm());
      }
    }
  }
}

TEST(LinearisedInnovation, IsThatOfPoseMapAndSensor) {
  RngStream draw({.seed = 237, .purpose = Draw::test});
  for (int n = 0; n < 500; ++n) {
    const RandomObservation c(draw);
    const LinearObservation truth(c);
    PoseGaussian<double> pose = c.pose;
    Evidence<double> evidence;
    const auto v = refine_pose(pose, c.landmark, c.seen, c.noise, Everywhere(), evidence);
    EXPECT_LT((covariance_of(v) - truth.whole()).norm(), 1e-13 * (1 + truth.whole().norm()));
    EXPECT_LT((cross_of(v) - truth.cross).norm(), 1e-13 * (1 + truth.cross.norm()));
    LandmarkGaussian<double> landmark = c.landmark;
    const Eigen::Matrix2d S = truth.of_map + truth.of_sensor;
    const auto of_known =
        update_landmark(landmark, c.pose.mean, c.seen, c.noise, Everywhere(), evidence);
    EXPECT_LT((covariance_of(of_known) - S).norm(), 1e-13 * (1 + S.norm()));
  }
}

}  // namespace
}  // namespace montecarta::filters
