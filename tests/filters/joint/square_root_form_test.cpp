// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_gaussian.hpp"
#include "tests/filters/reference/square_root_ekf_slam.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::filters {
namespace {

/// The noise of Ankishan et al., Simulation I.
const Belief kLargeNoise{.vehicle = {},
                         .control = {.sigma = {1.0, 10.0 * kPi / 180.0}},
                         .sigma_range = 1.2,
                         .sigma_bearing = 12.0 * kPi / 180.0};

Eigen::MatrixXd covariance_of(const JointGaussian& gaussian) {
  const Eigen::Index n = 2 * static_cast<Eigen::Index>(gaussian.landmarks());
  Eigen::MatrixXd P(3 + n, 3 + n);
  P.topLeftCorner<3, 3>() = gaussian.pose().covariance;
  P.bottomLeftCorner(n, 3) = gaussian.map().cross.topRows(n);
  P.topRightCorner(3, n) = P.bottomLeftCorner(n, 3).transpose();
  P.bottomRightCorner(n, n) =
      gaussian.map().covariance.topLeftCorner(n, n).selfadjointView<Eigen::Lower>();
  return P;
}

/// Distance of the covariance that production keeps from that of the square root.
struct Comparison {
  double worst = 0.0;             ///< of any entry, in standard deviations of its row and column
  double least_eigenvalue = 1.0;  ///< of production's correlations
  double least_square = 1.0;      ///< the same of the square root: of its singular values
  std::size_t faults = 0;

  void add(const JointGaussian& gaussian, const reference::SquareRootEkfSlam& root) {
    const Eigen::VectorXd norms = root.F.rowwise().norm();
    std::vector<Eigen::Index> uncertain;
    for (Eigen::Index i = 0; i < norms.size(); ++i) {
      if (norms(i) > 0.0) uncertain.push_back(i);
    }
    const Eigen::VectorXd scale = norms(uncertain).cwiseInverse();
    const Eigen::MatrixXd F = scale.asDiagonal() * root.F(uncertain, Eigen::all);
    const Eigen::MatrixXd P = covariance_of(gaussian)(uncertain, uncertain);
    const Eigen::MatrixXd C = scale.asDiagonal() * P * scale.asDiagonal();
    worst = std::max(worst, (C - F * F.transpose()).cwiseAbs().maxCoeff());
    least_eigenvalue = std::min(
        least_eigenvalue,
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(C, Eigen::EigenvaluesOnly).eigenvalues()(0));
    if (F.cols() < F.rows()) return;
    least_square = std::min(
        least_square, std::pow(Eigen::JacobiSVD<Eigen::MatrixXd>(F).singularValues().tail<1>()(0), 2));
  }
};

class SquareRootForm : public testing::TestWithParam<Retraction> {
 protected:
  void update_with(std::size_t slot, const RangeBearing<double>& detected) {
    ExpectedObservation expected;
    const auto status = gaussian.predict_observation(slot, expected);
    if (status == JointGaussian::ObservationStatus::faulty) ++comparison.faults;
    if (status != JointGaussian::ObservationStatus::usable) return;
    gaussian.update_with(slot, to_vector(detected), 0, expected);
    root.update_with(3 + 2 * static_cast<Eigen::Index>(slot), detected);
  }

  void drive(const SmallWorld& world, std::size_t scan) {
    MotionIncrement motion;
    for (std::size_t step = 8 * scan; step < 8 * (scan + 1); ++step) {
      motion.advance(world.drive.controls[step], world.itinerary.duration(step), kLargeNoise);
      root.predict(world.drive.controls[step], world.itinerary.duration(step));
    }
    gaussian.move(motion);
    std::vector<Detection> fresh;
    for (const Detection& detection : world.drive.scan(scan)) {
      const auto found = std::ranges::find(identities, detection.identity);
      if (found == identities.end()) {
        fresh.push_back(detection);
      } else {
        update_with(static_cast<std::size_t>(found - identities.begin()),
                    observation_of(detection));
      }
    }
    for (const Detection& detection : fresh) {
      identities.push_back(detection.identity);
      gaussian.append(vector_of(detection));
      root.append(observation_of(detection));
    }
  }

  JointGaussian gaussian{kLargeNoise, GetParam(), 20};
  reference::SquareRootEkfSlam root{kLargeNoise, GetParam()};
  std::vector<std::int32_t> identities;  ///< {slot}
  Comparison comparison;
};

/// Two rounds in the largest noise of the papers: there the covariance loses most to rounding.
TEST_P(SquareRootForm, EqualsTheProductionFilter) {
  const SmallWorld world =
      small_world({.seed = 41, .landmarks = 20, .scans = 570, .noise = kLargeNoise});
  gaussian.start({});
  root.start({});
  for (std::size_t scan = 0; scan < world.itinerary.scans(); ++scan) {
    drive(world, scan);
    if (scan % 10 == 9) comparison.add(gaussian, root);
  }
  EXPECT_EQ(comparison.faults, 0u);
  EXPECT_LT(comparison.worst, 1e-11);
  EXPECT_NEAR(comparison.least_eigenvalue, comparison.least_square, 1e-9);
  EXPECT_GT(comparison.least_square, 1e-3) << "where it is nought nothing is compared";
}

INSTANTIATE_TEST_SUITE_P(BothErrors, SquareRootForm,
                         testing::Values(Retraction::additive, Retraction::invariant));

}  // namespace
}  // namespace montecarta::filters
