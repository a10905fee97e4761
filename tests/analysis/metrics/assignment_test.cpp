// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/map_scores.hpp"
#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

namespace montecarta::analysis {
namespace {

double cost_of(const Eigen::MatrixXd& cost, const std::vector<std::size_t>& columns) {
  double sum = 0.0;
  for (Eigen::Index r = 0; r < cost.rows(); ++r) {
    sum += cost(r, static_cast<Eigen::Index>(columns[static_cast<std::size_t>(r)]));
  }
  return sum;
}

double least_of_all(const Eigen::MatrixXd& cost) {
  std::vector<std::size_t> order(static_cast<std::size_t>(cost.cols()));
  std::iota(order.begin(), order.end(), 0);
  double least = cost_of(cost, order);
  while (std::next_permutation(order.begin(), order.end())) {
    least = std::min(least, cost_of(cost, order));
  }
  return least;
}

TEST(Assignment, IsTheCheapestOfAll) {
  RngStream draw({.seed = 3});
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Index rows = 1 + draw.below(6), columns = rows + draw.below(2);
    Eigen::MatrixXd cost(rows, columns);
    // Whole numbers, so that many costs are equal.
    for (double& one : cost.reshaped()) one = static_cast<double>(draw.below(8)) - 2.0;
    const auto found = cheapest_assignment(cost);
    EXPECT_EQ(std::set(found.begin(), found.end()).size(), found.size()) << "each column once";
    EXPECT_DOUBLE_EQ(cost_of(cost, found), least_of_all(cost)) << trial;
  }
}

}  // namespace
}  // namespace montecarta::analysis
