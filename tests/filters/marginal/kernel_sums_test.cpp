// SPDX-License-Identifier: BSD-3-Clause
#include "filters/marginal/kernel_sums.hpp"

#include "filters/plain/gaussian.hpp"
#include "tests/filters/marginal/kernel_clouds.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta::filters {
namespace {

const StepContext kContext(1, 0, 0, Parallel::serial());

/// {target} log of the sums over w and over lambda.
template <class Real>
std::vector<std::array<double, 2>> log_sums(const KernelCloud<Real>& cloud, KernelSums method,
                                            double tolerance = 1e-9) {
  KernelSummation<Real, 2> summation(method, tolerance);
  summation.assign(cloud.kernels, {cloud.w, cloud.lambda});
  EXPECT_EQ(summation.used(), method);
  std::vector<std::array<Real, 2>> logs(cloud.targets.size());
  summation.sum(kContext, cloud.targets, logs);
  std::vector<std::array<double, 2>> flat;
  for (std::size_t i = 0; i < cloud.w.size(); ++i) {
    const auto& block = logs[i / kLanesOf<Real>];
    flat.push_back({get(block[0], i % kLanesOf<Real>), get(block[1], i % kLanesOf<Real>)});
  }
  return flat;
}

/// The sums as EQUATIONS 12 writes them.
std::vector<std::array<double, 2>> plain_log_sums(const KernelCloud<double>& cloud) {
  std::vector<std::array<double, 2>> logs;
  for (const Pose& target : cloud.targets) {
    double sum_w = 0.0, sum_lambda = 0.0;
    for (std::size_t j = 0; j < cloud.kernels.size(); ++j) {
      const Eigen::Vector3d off = boxminus(target, cloud.kernels[j].mean);
      const double density =
          std::exp(plain::log_gaussian<3>(off, symmetric(cloud.kernels[j].covariance)));
      sum_w += cloud.w[j] * density;
      sum_lambda += cloud.lambda[j] * density;
    }
    logs.push_back({std::log(sum_w), std::log(sum_lambda)});
  }
  return logs;
}

template <class A, class B>
double greatest_difference(const A& a, const B& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t n = 0; n < 2; ++n) most = std::max(most, std::abs(a[i][n] - b[i][n]));
  }
  return most;
}

constexpr double kFloors[] = {0.0005, 0.01, 0.1};  // [m]

TEST(DirectSums, EqualPlainEigenAcrossTheBackwardDirection) {
  for (const double heading : {0.3, kPi}) {
    for (const double floor : kFloors) {
      const KernelCloud<double> plain(53, 3.0, heading, floor);
      const auto expected = plain_log_sums(plain);
      EXPECT_LT(greatest_difference(log_sums(plain, KernelSums::direct), expected), 1e-9);
      const KernelCloud<Lanes> lanes(53, 3.0, heading, floor);
      EXPECT_EQ(lanes.w[7], plain.w[7]);
      EXPECT_LT(greatest_difference(log_sums(lanes, KernelSums::direct),
                                    log_sums(plain, KernelSums::direct)),
                1e-10);
    }
  }
}

TEST(DirectSums, EqualPlainEigenWhereHeadingsPointEverywhere) {
  const KernelCloud<double> plain(53, 1000.0, 0.3, 20.0);
  const KernelCloud<Lanes> lanes(53, 1000.0, 0.3, 20.0);
  const auto expected = plain_log_sums(plain);
  EXPECT_LT(greatest_difference(log_sums(plain, KernelSums::direct), expected), 1e-9);
  EXPECT_LT(greatest_difference(log_sums(lanes, KernelSums::direct), expected), 1e-9);
}

TEST(DirectSums, SurviveTargetsFarFromEveryKernel) {
  KernelCloud<Lanes> cloud(20, 1.0, 0.0, 0.01);
  set(cloud.targets[0].x, 3, 200.0);
  set(cloud.targets[1].heading, 2, 2.0);
  const auto logs = log_sums(cloud, KernelSums::direct);
  EXPECT_LT(logs[3][0], -1e5);
  EXPECT_TRUE(std::isfinite(logs[3][0] - logs[3][1]));
  EXPECT_TRUE(std::isfinite(logs[10][1]));
}

TEST(IfgtSums, EqualDirectOnesWhereKernelsAreBroadAndHeadingsAgree) {
  // a floor of half a metre dominates the kernels, so one covariance serves all
  const KernelCloud<Lanes> cloud(400, 3.0, 0.3, 0.5);
  EXPECT_LT(greatest_difference(log_sums(cloud, KernelSums::ifgt, 1e-9),
                                log_sums(cloud, KernelSums::direct)),
            1e-3);
}

TEST(IfgtSums, FallBackToDirectOnesWhereKernelsAreThin) {
  const KernelCloud<Lanes> cloud(100, 30.0, 0.3, 0.0005);
  KernelSummation<Lanes, 2> summation(KernelSums::ifgt, 1e-9);
  summation.assign(cloud.kernels, {cloud.w, cloud.lambda});
  EXPECT_EQ(summation.used(), KernelSums::direct);
}

}  // namespace
}  // namespace montecarta::filters
