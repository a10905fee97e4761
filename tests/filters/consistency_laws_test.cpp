// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_filter.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "filters/moments/gaussians.hpp"
#include "filters/plain/gaussian.hpp"
#include "tests/filters/consistent_anees.hpp"
#include "tests/filters/fastslam/filter_comparison.hpp"
#include "tests/filters/small_world.hpp"
#include "tests/filters/two_scans.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <vector>

namespace montecarta::filters {
namespace {

TEST(Consistency, EkfSlamIsConsistentWhereNoiseIsSmall) {
  constexpr std::uint64_t kRuns = 200;
  const auto filter = make_ekf_slam({.belief = fine(),
                                     .association = {},
                                     .options = default_options(ekf_slam_kind()),
                                     .landmarks = 20});
  const SmallWorldSettings settings{.seed = 500, .scans = 40, .noise = fine()};
  EXPECT_TRUE(is_consistent(final_errors(*filter, settings, kRuns).anees, kRuns));
}

/// Random symmetric positive definite matrix.
template <int N>
Eigen::Matrix<double, N, N> random_covariance(RngStream& draw) {
  Eigen::Matrix<double, N, N> A;
  for (int k = 0; k < A.size(); ++k) A(k) = draw.normal();
  return A * A.transpose() + 0.1 * Eigen::Matrix<double, N, N>::Identity();
}

PoseGaussian<double> gaussian_of(const Eigen::Vector3d& mean, const Eigen::Matrix3d& covariance) {
  return {{mean(0), mean(1), mean(2)}, symmetric_of(covariance)};
}

TEST(FastSlam2Weights, InALinearCaseTheRatioIsTheClosedFormWhateverWasDrawn) {
  // EQUATIONS (6.3): p(z | x) N(x; prior) / N(x; posterior) is p(z), for every x. Poses are
  // drawn and weighed by functions of the filters; a tenth keeps headings within half a turn.
  RngStream draw({.seed = 235, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const Eigen::Matrix3d P = 0.01 * random_covariance<3>(draw);
    const Eigen::Matrix2d S_f = 0.01 * random_covariance<2>(draw);
    const Matrix23 H = Matrix23::NullaryExpr([&](Eigen::Index) { return draw.normal(); });
    const Eigen::Vector2d nu(0.1 * draw.normal(), 0.1 * draw.normal());
    const Eigen::Matrix2d S_z = H * P * H.transpose() + S_f;
    const Matrix32 K = S_z.llt().solve(H * P).transpose();
    const Eigen::Vector3d shift = K * nu;
    const Eigen::Matrix3d P_after = P - K * S_z * K.transpose();
    const PoseGaussian<double> prior = gaussian_of({0.0, 0.0, 0.0}, P);
    const PoseGaussian<double> posterior = gaussian_of(shift, P_after);
    const double closed = plain::log_gaussian<2>(nu, S_z);
    for (int k = 0; k < 3; ++k) {
      const Pose pose =
          PoseFactor<double>(posterior).at(draw.normal(), draw.normal(), draw.normal());
      const Eigen::Vector3d x = boxminus(pose, Pose());
      const double likelihood = plain::log_gaussian<2>(nu - H * x, S_f);
      const double ratio =
          likelihood + plain::log_gaussian<3>(x, P) - plain::log_gaussian<3>(x - shift, P_after);
      EXPECT_NEAR(ratio, closed, 1e-9 * (1.0 + std::abs(closed))) << "case " << n << ", draw " << k;
      const double weight =
          likelihood + PoseDensity<double>(prior)(pose) - PoseDensity<double>(posterior)(pose);
      // PoseDensity adds 1e-12 m^2 to variances of 1e-4 m^2 and more.
      EXPECT_NEAR(weight, closed, 1e-6 * (1.0 + std::abs(closed)))
          << "case " << n << ", draw " << k;
    }
  }
}

TEST(FastSlam2, SeeingAgainFromAKnownPoseIsTheKalmanFiltersUpdate) {
  // Landmarks initialised at an exactly known pose are independent of it and of each other, so the
  // first scan that sees them again is the same Bayesian update for both filters, likelihood
  // included.
  const SmallWorld world = drive_of_two_scans();
  const auto kalman = make_ekf_slam({.belief = {},
                                     .association = {},
                                     .options = default_options(ekf_slam_kind()),
                                     .landmarks = 40});
  const PoseMoments expected = after_two_scans(*kalman, world).spread;
  EXPECT_GE(kalman->report().nis_dof, 4u);
  for (const std::size_t particles : {1, 30}) {
    const Variant variant{.filter = "fastslam2", .particles = particles};
    const SmallWorldSettings settings = settings_of_two_scans();
    const auto production = make_production(variant, settings);
    const auto plain = make_plain(variant, settings);
    for (SlamFilter* filter : {production.get(), plain.get()}) {
      const PoseMoments mixture = *after_two_scans(*filter, world).mixture;
      EXPECT_LT(boxminus(mixture.mean, expected.mean).norm(), 1e-12);
      EXPECT_LT((mixture.covariance - expected.covariance).norm(), 1e-13);
      EXPECT_NEAR(filter->report().log_likelihood, kalman->report().log_likelihood, 1e-9);
    }
  }
}

TEST(FastSlam2, WeighsAllDrawsAlikeByTheRatioOnLinearModels) {
  // The same of the filter itself: before the second scan the particles are equal, so their
  // weights stay equal, wherever each was drawn, and sum to the closed form.
  SmallWorldSettings settings = settings_of_two_scans();
  settings.noise = fine();
  const SmallWorld world = drive_of_two_scans(settings);
  const auto closed = make_production({.filter = "fastslam2", .particles = 50}, settings);
  after_two_scans(*closed, world);
  for (const char* name : {"fastslam2", "ufastslam", "srcd"}) {
    const auto filter =
        make_production({.filter = name, .weights = "ratio", .particles = 50}, settings);
    after_two_scans(*filter, world);
    std::vector<double> log_weights(50);
    filter->particles({.pose = {}, .log_weight = log_weights, .ancestor = {}});
    for (const double weight : log_weights) {
      EXPECT_NEAR(weight, -std::log(50.0), 1e-2) << name;
    }
    EXPECT_NEAR(filter->report().log_likelihood, closed->report().log_likelihood, 1e-2) << name;
  }
}

}  // namespace
}  // namespace montecarta::filters
