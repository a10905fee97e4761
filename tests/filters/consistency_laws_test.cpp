// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/nees_bounds.hpp"
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

double nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  return error.dot(covariance.llt().solve(error));
}

/// One vehicle in a linear world and the Kalman filter that knows the world's matrices.
class LinearRun {
 public:
  explicit LinearRun(std::uint64_t run) : draw_({.seed = 2310, .run = run, .purpose = Draw::test}) {
    F_ << 0.8, 0.1, 0.0, -0.1, 0.7, 0.2, 0.0, 0.1, 0.6;
    G_ << 1.0, 0.0, 0.3, 0.5, 0.0, 0.8;  // two noises drive three states, as in a vehicle
    H_ << 1.0, 0.0, 0.5, 0.0, 1.0, -0.4;
  }

  /// One step, one measurement; returns the NEES after it.
  double advance() {
    const Eigen::Vector2d process(draw_.normal(), draw_.normal());
    truth_ = (F_ * truth_ + G_ * process).eval();
    P_ = (F_ * P_ * F_.transpose() + G_ * G_.transpose()).eval();
    mean_ = (F_ * mean_).eval();
    const Eigen::Vector2d sensor(draw_.normal(), draw_.normal());
    const Eigen::Vector2d innovation = H_ * (truth_ - mean_) + sensor;
    const Eigen::Matrix2d S = H_ * P_ * H_.transpose() + Eigen::Matrix2d::Identity();
    const Matrix32 K = S.llt().solve(H_ * P_).transpose();
    mean_ += K * innovation;
    P_ -= (K * S * K.transpose()).eval();
    return nees(truth_ - mean_, P_);
  }

 private:
  RngStream draw_;
  Eigen::Matrix3d F_;
  Matrix32 G_;
  Matrix23 H_;
  Eigen::Vector3d truth_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d P_ = Eigen::Matrix3d::Zero();
};

TEST(Consistency, AMatchedLinearWorldStaysInsideItsBand) {
  constexpr std::uint64_t kRuns = 30;
  constexpr int kSteps = 4000;
  std::vector<LinearRun> runs;
  for (std::uint64_t run = 0; run < kRuns; ++run) runs.emplace_back(run);
  for (LinearRun& run : runs) {
    run.advance(), run.advance();  // two noises need two steps to fill three dimensions
  }
  const analysis::Interval band = analysis::nees_bounds(kRuns, 3, 0.95);
  int inside = 0;
  double total = 0.0;
  for (int step = 0; step < kSteps; ++step) {
    double sum = 0.0;
    for (LinearRun& run : runs) sum += run.advance();
    const double anees = sum / static_cast<double>(kRuns);
    inside += anees >= band.lower && anees <= band.upper;
    total += anees;
  }
  // 120,000 chi-squares, neighbours correlated by 0.8 or less: standard error below 0.02.
  EXPECT_NEAR(total / kSteps, 3.0, 0.1);
  EXPECT_GE(inside, 0.94 * kSteps);
  EXPECT_LE(inside, 0.96 * kSteps);
}

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
