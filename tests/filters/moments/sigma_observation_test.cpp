// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/moment_transforms.hpp"
#include "tests/filters/moments/random_gaussians.hpp"
#include "tests/filters/reference/sigma_models.hpp"
#include "tests/filters/reference/square_root.hpp"

#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

using reference::across_first;
using reference::across_first_with_heading;
using reference::blocks;
using reference::chol_in;
using reference::Image;
using reference::Vector;

const double kInterval = std::sqrt(3.0);

/// The literal image of (pose, landmark, sensor noise), seven dimensions and fifteen points.
template <class Transform>
Image<7, 2> literal_observation(const RandomObservation& c, const Transform& transform) {
  Vector<7> x = Vector<7>::Zero();
  x.head<3>() = reference::to_vector(c.pose.mean);
  x.segment<2>(3) = to_vector(c.landmark.mean);
  const Vector<2> R(std::sqrt(c.noise.range), std::sqrt(c.noise.bearing));
  const Eigen::Matrix2d root = R.asDiagonal();
  const Vector<3> pose = x.head<3>();
  const Vector<2> landmark = x.segment<2>(3);
  const auto S = blocks<3, 2, 2>(
      chol_in<3>(across_first_with_heading(pose, landmark), symmetric(c.pose.covariance)),
      chol_in<2>(across_first(pose, landmark), symmetric(c.landmark.covariance)), root);
  return transform(x, S, reference::ObservationModel{});
}
const auto kUnscented = [](const auto& x, const auto& S, const auto& model) {
  return reference::unscented<2, 1>(x, S, {.alpha = 0.9, .beta = 2.0, .kappa = -2.0}, model);
};
const auto kCentral = [](const auto& x, const auto& S, const auto& model) {
  const auto image = reference::central_differences<2, 1>(x, S, kInterval, model);
  return Image<7, 2>{image.mean, image.A * image.A.transpose() + image.B * image.B.transpose(),
                     S * image.A.transpose()};
};

void expect_refined_as(const RandomObservation& c, const Image<7, 2>& image,
                       const SigmaRule& rule) {
  const Eigen::Matrix<double, 3, 2> C = image.cross.topRows<3>();
  const Eigen::Matrix<double, 3, 2> K = image.covariance.llt().solve(C.transpose()).transpose();
  const Vector<2> nu = reference::difference<1, 2>(to_vector(c.seen), image.mean);
  const Vector<3> mean = reference::to_vector(c.pose.mean) + K * nu;
  const Eigen::Matrix3d P = symmetric(c.pose.covariance) - K * image.covariance * K.transpose();

  PoseGaussian<double> pose = c.pose;
  Evidence<double> evidence;
  refine_pose_by_sigma_points(pose, c.landmark, c.seen, c.noise, Everywhere(), evidence, rule,
                              MapUncertainty::on);
  EXPECT_LT((reference::to_vector(pose.mean) - mean).norm(), 1e-11);
  EXPECT_LT((symmetric(pose.covariance) - P).norm(), 1e-12);
  EXPECT_NEAR(evidence.log_density(), reference::log_gaussian<2>(nu, image.covariance), 1e-9);
}

TEST(SigmaObservation, RefinesAPoseAsFifteenPointsOfSevenDimensionsDo) {
  RngStream draw({.seed = 83, .purpose = Draw::test});
  for (int n = 0; n < 500; ++n) {
    const RandomObservation c(draw);
    expect_refined_as(c, literal_observation(c, kUnscented), unscented_rule(5, 0.9, 2, 0));
    expect_refined_as(c, literal_observation(c, kCentral), central_difference_rule(kInterval));
  }
}

/// Updates by the square-root recursion of EQUATIONS 8, which never forms a covariance.
TEST(SigmaObservation, UpdatesALandmarkAsTheSquareRootRecursionDoes) {
  RngStream draw({.seed = 93, .purpose = Draw::test});
  for (int n = 0; n < 500; ++n) {
    const RandomObservation c(draw);
    const Vector<3> pose = reference::to_vector(c.pose.mean);
    const Vector<2> mu = to_vector(c.landmark.mean);
    const Eigen::Matrix2d S = chol_in<2>(across_first(pose, mu), symmetric(c.landmark.covariance));
    const auto image = reference::central_differences<2, 1>(mu, S, kInterval,
                                                            reference::LandmarkModel{c.pose.mean});
    const Vector<2> R(std::sqrt(c.noise.range), std::sqrt(c.noise.bearing));
    const Eigen::Matrix2d root = R.asDiagonal();
    Eigen::Matrix<double, 2, 6> columns;
    columns << image.A, image.B, root;
    const Eigen::Matrix2d S_y = reference::tria<2, 6>(columns);
    const Eigen::Matrix2d K = reference::gain<2, 2>(S * image.A.transpose(), S_y);
    columns << S - K * image.A, K * image.B, K * root;
    const Eigen::Matrix2d after = reference::tria<2, 6>(columns);
    const Vector<2> nu = reference::difference<1, 2>(to_vector(c.seen), image.mean);

    LandmarkGaussian<double> landmark = c.landmark;
    Evidence<double> evidence;
    update_landmark_by_sigma_points(landmark, c.pose.mean, c.seen, c.noise, Everywhere(), evidence,
                                    central_difference_rule(kInterval));
    EXPECT_LT((to_vector(landmark.mean) - mu - K * nu).norm(), 1e-12);
    EXPECT_LT((symmetric(landmark.covariance) - after * after.transpose()).norm(), 1e-12);
    EXPECT_NEAR(evidence.log_density(), reference::log_gaussian<2>(nu, S_y * S_y.transpose()),
                1e-9);
  }
}

TEST(SigmaObservation, InitialisesALandmarkAsFivePointsDo) {
  RngStream draw({.seed = 94, .purpose = Draw::test});
  for (int n = 0; n < 500; ++n) {
    const RandomObservation c(draw);
    const Vector<2> R(std::sqrt(c.noise.range), std::sqrt(c.noise.bearing));
    const Eigen::Matrix2d root = R.asDiagonal();
    const auto image = reference::unscented<2, -1>(to_vector(c.seen), root, {},
                                                   reference::PlaceModel{c.pose.mean});
    const SigmaRule rule = unscented_rule(2, 0.9, 2, 0);
    const auto initialised = new_landmark_by_sigma_points(c.pose.mean, c.seen, c.noise, rule,
                                                          direction_of(rule.spread * R(1)));
    EXPECT_LT((to_vector(initialised.mean) - image.mean).norm(), 1e-12);
    EXPECT_LT((symmetric(initialised.covariance) - image.covariance).norm(), 1e-12);
  }
}

/// Noise so small that the models are linear within it.
TEST(SigmaObservation, OnLinearModelsEveryTransformIsTheKalmanFilter) {
  RngStream draw({.seed = 84, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const double scale = 1e-5;
    const RandomObservation c(draw, scale);
    for (const SigmaRule& rule :
         {unscented_rule(5, 0.9, 2, 0), central_difference_rule(kInterval)}) {
      PoseGaussian<double> sigma = c.pose, linear = c.pose;
      Evidence<double> of_bent, of_linear;
      refine_pose_by_sigma_points(sigma, c.landmark, c.seen, c.noise, Everywhere(), of_bent, rule,
                                  MapUncertainty::on);
      refine_pose(linear, c.landmark, c.seen, c.noise, Everywhere(), of_linear);
      EXPECT_LT(boxminus(sigma.mean, linear.mean).norm(), 1e-3 * scale);
      EXPECT_LT((symmetric(sigma.covariance) - symmetric(linear.covariance)).norm(),
                1e-3 * scale * scale);
      EXPECT_NEAR(of_bent.log_density(), of_linear.log_density(), 1e-2);
    }
  }
}

TEST(SigmaObservation, ALandmarkLeftOutOfTheProposalStaysInTheWeight) {
  RngStream draw({.seed = 85, .purpose = Draw::test});
  const SigmaRule rule = central_difference_rule(kInterval);
  for (int n = 0; n < 200; ++n) {
    const RandomObservation c(draw);
    RandomObservation sure = c;
    sure.landmark.covariance = {};
    PoseGaussian<double> on = c.pose, off = c.pose, known = c.pose;
    Evidence<double> of_on, of_off, of_known;
    refine_pose_by_sigma_points(on, c.landmark, c.seen, c.noise, Everywhere(), of_on, rule,
                                MapUncertainty::on);
    refine_pose_by_sigma_points(off, c.landmark, c.seen, c.noise, Everywhere(), of_off, rule,
                                MapUncertainty::off);
    refine_pose_by_sigma_points(known, sure.landmark, c.seen, c.noise, Everywhere(), of_known, rule,
                                MapUncertainty::on);
    EXPECT_LT(boxminus(off.mean, known.mean).norm(), 1e-12);
    EXPECT_LT((symmetric(off.covariance) - symmetric(known.covariance)).norm(), 1e-12);
    EXPECT_NEAR(of_off.log_density(), of_on.log_density(), 1e-10);
    EXPECT_LT(symmetric(off.covariance).trace(), symmetric(on.covariance).trace());
  }
}

}  // namespace
}  // namespace montecarta::filters
