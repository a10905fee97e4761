// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/worst_direction.hpp"

#include "analysis/statistics/run_mean.hpp"
#include "analysis/statistics/symmetric_eigen.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <utility>

namespace montecarta::analysis {
namespace {

using Samples = Eigen::MatrixXd;  // {component, scan} errors of scans with errors in all components

Samples samples_of(const std::vector<double>& errors, Eigen::Index dimension) {
  const auto scans = static_cast<Eigen::Index>(errors.size()) / dimension;
  Samples whole(dimension, scans);
  Eigen::Index n = 0;
  for (Eigen::Index s = 0; s < scans; ++s) {
    const Eigen::Map<const Eigen::VectorXd> error(errors.data() + s * dimension, dimension);
    if (!error.array().isNaN().any()) whole.col(n++) = error;
  }
  return whole.leftCols(n);
}

/// Returns the mean of u u' over scans and runs, without its diagonal.
Eigen::MatrixXd mean_products(const std::vector<Samples>& runs, std::size_t first,
                              Eigen::Index dimension) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(dimension, dimension);
  double n = 0.0;
  for (std::size_t i = first; i < runs.size(); i += 2) {
    sum.noalias() += runs[i] * runs[i].transpose();
    n += static_cast<double>(runs[i].cols());
  }
  sum.diagonal().setZero();
  return sum / n;
}

/// Returns the eigenvector of the eigenvalue that is farthest from zero.
Eigen::VectorXd farthest_direction(const Eigen::MatrixXd& products) {
  const SymmetricEigen eigen = symmetric_eigen(products);
  Eigen::Index farthest = 0;
  eigen.values.cwiseAbs().maxCoeff(&farthest);
  return eigen.vectors.col(farthest);
}

/// Returns the mean over scans of the products of different components of a run along a direction.
double along(const Eigen::VectorXd& direction, const Samples& run) {
  const Eigen::ArrayXd squares =
      (direction.transpose() * run).array().square().transpose() -
      (direction.array().square().matrix().transpose() * run.array().square().matrix())
          .array()
          .transpose();
  return squares.mean();
}

/// Returns the two components with the largest product in a direction.
std::pair<Eigen::Index, Eigen::Index> pair_of(const Eigen::VectorXd& direction) {
  Eigen::Index first = 0, second = 0;
  direction.cwiseAbs().maxCoeff(&first);
  Eigen::VectorXd rest = direction;
  rest(first) = 0.0;
  rest.cwiseAbs().maxCoeff(&second);
  return std::minmax(first, second);
}

}  // namespace

std::vector<MemberTest> direction_tests(const ErrorsOfRuns& runs, double ratio,
                                        std::span<const std::string> components) {
  const auto dimension = static_cast<Eigen::Index>(components.size());
  std::vector<Samples> whole;
  for (const std::vector<double>& run : runs) {
    Samples samples = samples_of(run, dimension);
    if (samples.cols() > 0) whole.push_back(std::move(samples));
  }
  std::vector<MemberTest> all;
  constexpr std::size_t kFewestRunsOfDirections = 6;  // three runs choose and three runs judge
  if (whole.size() < kFewestRunsOfDirections) return all;
  for (const std::size_t chosen_by : {std::size_t{0}, std::size_t{1}}) {
    const Eigen::VectorXd direction =
        farthest_direction(mean_products(whole, chosen_by, dimension));
    const auto [a, b] = pair_of(direction);
    const double sign = direction(a) * direction(b) < 0.0 ? -1.0 : 1.0;  // sign of the pair
    SummaryOf values;
    for (std::size_t i = 1 - chosen_by; i < whole.size(); i += 2) {
      values.add(sign * along(direction, whole[i]));
    }
    const RunMean mean = RunMean::of_product(values.result()).in_units_of(ratio);
    Member member{.name = components[static_cast<std::size_t>(a)] + " and " +
                          components[static_cast<std::size_t>(b)],
                  .estimate = mean.mean()};
    member.p = mean.p_value(0.0);
    all.push_back({Family::correlation, std::move(member),
                   [mean](double level) { return mean.interval(level); }});
  }
  return all;
}

}  // namespace montecarta::analysis
