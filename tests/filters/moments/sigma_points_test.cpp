// SPDX-License-Identifier: BSD-3-Clause
// Updates by sigma points, compared with the papers' formulas.
#include "filters/moments/sigma_points.hpp"

#include "filters/plain/sigma_points.hpp"
#include "filters/plain/square_roots.hpp"
#include "tests/filters/moments/random_gaussians.hpp"

#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

using plain::across_first;
using plain::across_first_with_heading;
using plain::blocks;
using plain::chol_in;
using plain::Image;
using plain::Vector;

const double kInterval = std::sqrt(3.0);

/// Uses `rule` in every stage; `noise` sets the rays of a new landmark.
SigmaPoints points_by(const SigmaRule& rule, const SensorNoise& noise,
                      MapUncertainty map_uncertainty = MapUncertainty::on) {
  Belief belief;
  belief.sigma_bearing = std::sqrt(noise.second);
  return SigmaPoints({.motion = rule, .pose = rule, .landmark = rule}, belief, map_uncertainty);
}

/// The literal image of (pose, landmark, sensor noise), seven dimensions and fifteen points.
template <class Transform>
Image literal_observation(const RandomObservation& c, const Transform& transform) {
  Vector<7> x = Vector<7>::Zero();
  x.head<3>() = plain::to_vector(c.pose.mean);
  x.segment<2>(3) = to_vector(c.landmark.mean);
  const Vector<2> R(std::sqrt(c.noise.first), std::sqrt(c.noise.second));
  const Eigen::Matrix2d root = R.asDiagonal();
  const Vector<3> pose = x.head<3>();
  const Vector<2> landmark = x.segment<2>(3);
  const auto S =
      blocks({chol_in(across_first_with_heading(pose, landmark), symmetric(c.pose.covariance)),
              chol_in(across_first(pose, landmark), symmetric(c.landmark.covariance)), root});
  return transform(x, S, plain::observation_model());
}
const auto kUnscented = [](const auto& x, const auto& S, const auto& model) {
  return plain::unscented(x, S, {.alpha = 0.9, .beta = 2.0, .kappa = -2.0}, model);
};
const auto kCentral = [](const auto& x, const auto& S, const auto& model) {
  const auto image = plain::central_differences(x, S, kInterval, model);
  return Image{image.mean, image.A * image.A.transpose() + image.B * image.B.transpose(),
               S * image.A.transpose()};
};

void expect_refined_as(const RandomObservation& c, const Image& image, const SigmaRule& rule) {
  const Eigen::Matrix<double, 3, 2> C = image.cross.topRows(3);
  const Eigen::Matrix<double, 3, 2> K = image.covariance.llt().solve(C.transpose()).transpose();
  const Vector<2> nu = plain::observation_model().wrapped(to_vector(c.seen) - image.mean);
  const Vector<3> mean = plain::to_vector(c.pose.mean) + K * nu;
  const Eigen::Matrix3d P = symmetric(c.pose.covariance) - K * image.covariance * K.transpose();

  PoseGaussian<double> pose = c.pose;
  Evidence<double> evidence;
  points_by(rule, c.noise).refine(pose, c.landmark, c.seen, c.noise, AllLanes(), evidence);
  EXPECT_LT((plain::to_vector(pose.mean) - mean).norm(), 1e-11);
  EXPECT_LT((symmetric(pose.covariance) - P).norm(), 1e-12);
  EXPECT_NEAR(evidence.log_density(), plain::log_gaussian<2>(nu, image.covariance), 1e-9);
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
    const Vector<3> pose = plain::to_vector(c.pose.mean);
    const Vector<2> mu = to_vector(c.landmark.mean);
    const Eigen::Matrix2d S = chol_in(across_first(pose, mu), symmetric(c.landmark.covariance));
    const auto image =
        plain::central_differences(mu, S, kInterval, plain::landmark_model(c.pose.mean));
    const Vector<2> R(std::sqrt(c.noise.first), std::sqrt(c.noise.second));
    const Eigen::Matrix2d root = R.asDiagonal();
    const Eigen::Matrix2d S_y = plain::tria_of({image.A, image.B, root});
    const Eigen::Matrix2d K = plain::square_root_gain(S * image.A.transpose(), S_y);
    const Eigen::Matrix2d after = plain::tria_of({S - K * image.A, K * image.B, K * root});
    const Vector<2> nu = plain::observation_model().wrapped(to_vector(c.seen) - image.mean);

    LandmarkGaussian<double> landmark = c.landmark;
    Evidence<double> evidence;
    points_by(central_difference_rule(kInterval), c.noise)
        .update(landmark, c.pose.mean, c.seen, c.noise, AllLanes(), evidence);
    EXPECT_LT((to_vector(landmark.mean) - mu - K * nu).norm(), 1e-12);
    EXPECT_LT((symmetric(landmark.covariance) - after * after.transpose()).norm(), 1e-12);
    EXPECT_NEAR(evidence.log_density(), plain::log_gaussian<2>(nu, S_y * S_y.transpose()), 1e-9);
  }
}

TEST(SigmaObservation, InitialisesALandmarkAsFivePointsDo) {
  RngStream draw({.seed = 94, .purpose = Draw::test});
  for (int n = 0; n < 500; ++n) {
    const RandomObservation c(draw);
    const Vector<2> R(std::sqrt(c.noise.first), std::sqrt(c.noise.second));
    const Eigen::Matrix2d root = R.asDiagonal();
    const auto image =
        plain::unscented(to_vector(c.seen), root, {}, plain::place_model(c.pose.mean));
    const SigmaRule rule = unscented_rule(2, 0.9, 2, 0);
    const auto initialised = points_by(rule, c.noise).initialise(c.pose.mean, c.seen, c.noise);
    EXPECT_LT((to_vector(initialised.mean) - image.mean).norm(), 1e-12);
    EXPECT_LT((symmetric(initialised.covariance) - image.covariance).norm(), 1e-12);
  }
}

TEST(SigmaObservation, InitialisesALandmarkAsPrintedWithTheNoiseOnceMore) {
  RngStream draw({.seed = 95, .purpose = Draw::test});
  const RandomObservation c(draw);
  const SigmaRule rule = central_difference_rule(kInterval);
  Belief belief;
  belief.sigma_bearing = std::sqrt(c.noise.second);
  const auto initialised = [&](NewLandmarks new_landmarks) {
    return SigmaPoints({rule, rule, rule}, belief, MapUncertainty::on, new_landmarks)
        .initialise(c.pose.mean, c.seen, c.noise);
  };
  const auto corrected = initialised(NewLandmarks::corrected);
  const auto printed = initialised(NewLandmarks::as_printed);
  EXPECT_EQ(to_vector(printed.mean), to_vector(corrected.mean));
  const Eigen::Matrix2d more = symmetric(printed.covariance) - symmetric(corrected.covariance);
  const Eigen::Matrix2d R = Vector<2>(c.noise.first, c.noise.second).asDiagonal();
  EXPECT_LT((more - R).norm(), 1e-12);
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
      points_by(rule, c.noise).refine(sigma, c.landmark, c.seen, c.noise, AllLanes(), of_bent);
      Linearised().refine(linear, c.landmark, c.seen, c.noise, AllLanes(), of_linear);
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
    points_by(rule, c.noise).refine(on, c.landmark, c.seen, c.noise, AllLanes(), of_on);
    points_by(rule, c.noise, MapUncertainty::off)
        .refine(off, c.landmark, c.seen, c.noise, AllLanes(), of_off);
    points_by(rule, c.noise).refine(known, sure.landmark, c.seen, c.noise, AllLanes(), of_known);
    EXPECT_LT(boxminus(off.mean, known.mean).norm(), 1e-12);
    EXPECT_LT((symmetric(off.covariance) - symmetric(known.covariance)).norm(), 1e-12);
    EXPECT_NEAR(of_off.log_density(), of_on.log_density(), 1e-10);
    EXPECT_LT(symmetric(off.covariance).trace(), symmetric(on.covariance).trace());
  }
}

Eigen::Matrix2d covariance_of(const Innovation<double>& v) {
  return Eigen::Matrix2d{{v.S.xx, v.S.xy}, {v.S.xy, v.S.yy}};
}
/// P_xz, the columns by range and by bearing.
Matrix32 cross_of(const Innovation<double>& v) {
  Matrix32 C;
  C << v.first.x, v.second.x, v.first.y, v.second.y, v.first.h, v.second.h;
  return C;
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
    of_sensor = Vector<2>(c.noise.first, c.noise.second).asDiagonal();
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
    const auto v = Linearised().refine(pose, c.landmark, c.seen, c.noise, AllLanes(), evidence);
    EXPECT_LT((covariance_of(v) - truth.whole()).norm(), 1e-13 * (1 + truth.whole().norm()));
    EXPECT_LT((cross_of(v) - truth.cross).norm(), 1e-13 * (1 + truth.cross.norm()));
    LandmarkGaussian<double> landmark = c.landmark;
    const Eigen::Matrix2d S = truth.of_map + truth.of_sensor;
    const auto of_known =
        Linearised().update(landmark, c.pose.mean, c.seen, c.noise, AllLanes(), evidence);
    EXPECT_LT((covariance_of(of_known) - S).norm(), 1e-13 * (1 + S.norm()));
  }
}

}  // namespace
}  // namespace montecarta::filters
