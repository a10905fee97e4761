// SPDX-License-Identifier: BSD-3-Clause
#include "filters/relative/relative_chain.hpp"

#include "filters/relative/relative_conditioning.hpp"
#include "tests/filters/relative/some_chain.hpp"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace montecarta::filters {
namespace {

std::vector<RelativeChain::Point> points_of(const RelativeChain& chain) {
  std::vector<RelativeChain::Point> points;
  for (const auto& [first, again] : chain.landmarks) points.push_back(first);
  return points;
}

/// Nodes and weights of Gauss-Hermite quadrature of a standard normal.
using Nodes = std::vector<std::pair<double, double>>;
const Nodes kNine = [] {
  const std::array<std::array<double, 2>, 5> half{{{0.0, 0.40634920634920635},
                                                   {1.0232556637891326, 0.2440975028949394},
                                                   {2.07684797867783, 0.049916406765217880},
                                                   {3.2054290028564703, 0.0027891413212317646},
                                                   {4.512745863399783, 2.2345844007746584e-05}}};
  Nodes nodes{{half[0][0], half[0][1]}};
  for (std::size_t i = 1; i < half.size(); ++i) {
    nodes.emplace_back(half[i][0], half[i][1]);
    nodes.emplace_back(-half[i][0], half[i][1]);
  }
  return nodes;
}();
const Nodes kTwo{{1.0, 0.5}, {-1.0, 0.5}};

/// Sums weight * places and their outer products over a grid: nine nodes for each of the angles,
/// which come first in `order`, and two for each of the rest, in which places are linear.
class Quadrature {
 public:
  Quadrature(const SomeChain& some, const std::vector<Eigen::Index>& order, std::size_t angles)
      : some_(some), order_(order), angles_(angles) {
    const Eigen::MatrixXd P = some.P(order, order);
    L_ = P.llt().matrixL();
    normal_ = Eigen::VectorXd::Zero(P.rows());
    const Eigen::Index size = in_map(some.chain, some.mean).size();
    mean = Eigen::VectorXd::Zero(size);
    covariance = Eigen::MatrixXd::Zero(size, size);
    visit(0, 1.0);
    covariance -= mean * mean.transpose();
  }
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;

 private:
  void visit(std::size_t i, double weight) {
    if (i == order_.size()) {
      const Eigen::VectorXd way = L_ * normal_;
      Eigen::VectorXd x = some_.mean;
      for (std::size_t j = 0; j < order_.size(); ++j)
        x(order_[j]) += way(static_cast<Eigen::Index>(j));
      const Eigen::VectorXd places = in_map(some_.chain, x);
      mean += weight * places;
      covariance += weight * places * places.transpose();
      return;
    }
    for (const auto& [node, share] : i < angles_ ? kNine : kTwo) {
      normal_(static_cast<Eigen::Index>(i)) = node;
      visit(i + 1, weight * share);
    }
  }

  const SomeChain& some_;
  const std::vector<Eigen::Index>& order_;
  std::size_t angles_;
  Eigen::MatrixXd L_;
  Eigen::VectorXd normal_;
};

// Two displacements, a landmark in polar coordinates in the frame between and one in Cartesian
// ones.
TEST(ChainMoments, AreThoseOfQuadrature) {
  SomeChain some = some_chain(0.25);
  some.chain.displacements = {5, 0};
  some.chain.landmarks = {{{3, 1, true}, {}}, {{13, 0, false}, {}}};
  const std::vector<Eigen::Index> order{2, 7, 4, 0, 1, 3, 5, 6, 13, 14};
  const Quadrature expected(some, order, 3);
  const JointEstimate now = ChainMoments().of(some.chain, some.mean, some.P, points_of(some.chain));
  EXPECT_LT((now.mean - expected.mean).norm(), 1e-8);
  EXPECT_LT((now.covariance - expected.covariance).norm(), 1e-7);
  EXPECT_GT((now.mean - in_map(some.chain, some.mean)).norm(), 0.1) << "bends nothing";
}

TEST(ChainMoments, AreThoseOfTheDerivativesWhereUncertaintyIsSmall) {
  SomeChain some = some_chain(0.25);
  some.P *= 1e-10;
  const Eigen::VectorXd at = in_map(some.chain, some.mean);
  Eigen::MatrixXd J(at.size(), 16);
  for (Eigen::Index i = 0; i < 16; ++i) {
    const Eigen::VectorXd way = 1e-5 * Eigen::VectorXd::Unit(16, i);
    J.col(i) = (in_map(some.chain, some.mean + way) - in_map(some.chain, some.mean - way)) / 2e-5;
  }
  const JointEstimate now = ChainMoments().of(some.chain, some.mean, some.P, points_of(some.chain));
  const Eigen::MatrixXd expected = J * some.P * J.transpose();
  EXPECT_LT((now.mean - at).norm(), 1e-8);
  EXPECT_LT((now.covariance - expected).norm(), 1e-8 * expected.norm());
}

TEST(ChainMoments, OfACertainChainAreItself) {
  const SomeChain some = some_chain(0.0);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(16, 16);
  const JointEstimate now = ChainMoments().of(some.chain, some.mean, none, points_of(some.chain));
  EXPECT_LT((now.mean - in_map(some.chain, some.mean)).norm(), 1e-14 * now.mean.norm());
  EXPECT_TRUE(now.covariance.isZero(0.0));
}

/// The vehicle's pose in the frame of each landmark, and the coordinates of the landmark, put
/// together by some matrices.
Eigen::VectorXd measured(const RelativeChain& chain, const Eigen::VectorXd& x,
                         const LinearisedPairs& pairs) {
  VehicleInFrames vehicle;
  vehicle.linearise(chain, x, 0);
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(pairs.residual.size());
  for (const auto& [pair, frame, row, by_pose, by_point] : pairs.parts) {
    const Pose& pose = vehicle.in(frame);
    sums.segment<2>(2 * pair) +=
        by_pose * Eigen::Vector3d(pose.x, pose.y, pose.heading) + by_point * x.segment<2>(row);
  }
  return sums;
}

/// Two pairs, of which one is of two landmarks.
LinearisedPairs some_pairs() {
  Matrix23 A, B, C;
  A << 1.0, 2.0, -0.5, 0.3, -1.0, 2.0;
  B << 0.2, 0.7, 1.5, -0.4, 0.1, 0.9;
  C << -1.0, 0.5, 0.25, 0.6, 0.6, -2.0;
  LinearisedPairs pairs{.residual = Eigen::VectorXd::Zero(4), .parts = {}};
  pairs.parts = {{1, 2, 13, A, A.leftCols<2>()},
                 {0, 1, 3, B, B.leftCols<2>()},
                 {1, 0, 11, C, C.leftCols<2>()}};
  return pairs;
}

TEST(VehicleInFrames, ProductsAreThoseWithTheDifferenceQuotients) {
  const SomeChain some = some_chain(0.2);
  const LinearisedPairs pairs = some_pairs();
  Eigen::MatrixXd H(4, 16);
  for (Eigen::Index i = 0; i < 16; ++i) {
    const Eigen::VectorXd way = 1e-6 * Eigen::VectorXd::Unit(16, i);
    H.col(i) = (measured(some.chain, some.mean + way, pairs) -
                measured(some.chain, some.mean - way, pairs)) /
               2e-6;
  }
  VehicleInFrames vehicle;
  vehicle.linearise(some.chain, some.mean, 0);
  Eigen::MatrixXd PH;
  vehicle.columns(some.chain, some.P, pairs, PH);
  EXPECT_LT((PH - some.P * H.transpose()).norm(), 1e-8);
  EXPECT_LT((vehicle.rows(some.chain, pairs, PH) - H * PH).norm(), 1e-7);
}

}  // namespace
}  // namespace montecarta::filters
