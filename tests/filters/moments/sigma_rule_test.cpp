// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/sigma_rule.hpp"

#include "engine/random/stream.hpp"
#include "filters/plain/sigma_points.hpp"

#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

using plain::Image;
using plain::Vector;

/// A vector of three functions of N variables, bent in all of them.
template <int N>
struct Bent {
  Eigen::Matrix<double, 3, N> slope;
  Eigen::Matrix<double, 3, N> turning_angle;
  explicit Bent(RngStream& draw) {
    for (double& value : slope.reshaped()) value = draw.normal();
    for (double& value : turning_angle.reshaped()) value = draw.normal();
  }
  Vector<3> operator()(const Vector<N>& x) const {
    return slope * x + turning_angle * x.cwiseProduct(x) +
           (turning_angle * x).array().sin().matrix();
  }
};

/// The moments as SigmaRule promises them.
template <int N>
Image<N, 3> by_rule(const SigmaRule& rule, const Vector<N>& x, const Eigen::Matrix<double, N, N>& S,
                    const Bent<N>& model) {
  const Vector<3> centre = model(x);
  Vector<3> e = Vector<3>::Zero();
  Image<N, 3> image;
  image.covariance.setZero(), image.cross.setZero();
  for (int j = 0; j < N; ++j) {
    const Vector<N> ahead = x + rule.spread * S.col(j), behind = x - rule.spread * S.col(j);
    const Vector<3> D = (model(ahead) - model(behind)) / 2.0;
    const Vector<3> E = (model(ahead) + model(behind)) / 2.0 - centre;
    e += rule.mean_weight * E;
    image.covariance += rule.antisymmetric * D * D.transpose();
    image.covariance += rule.symmetric * E * E.transpose();
    image.cross += rule.antisymmetric * rule.spread * S.col(j) * D.transpose();
  }
  image.mean = centre + e;
  image.covariance += rule.shift * e * e.transpose();
  return image;
}

template <int N>
Eigen::Matrix<double, N, N> random_factor(RngStream& draw) {
  Eigen::Matrix<double, N, N> S;
  for (double& value : S.reshaped()) value = 0.3 * draw.normal();
  return S;
}
template <int N>
Vector<N> random_vector(RngStream& draw) {
  return Vector<N>::NullaryExpr([&](Eigen::Index) { return draw.normal(); });
}

template <int N>
void expect_near(const Image<N, 3>& a, const Image<N, 3>& b) {
  const double size = 1.0 + b.covariance.norm() + b.mean.norm();
  EXPECT_LT((a.mean - b.mean).norm(), 1e-13 * size);
  EXPECT_LT((a.covariance - b.covariance).norm(), 1e-12 * size);
  EXPECT_LT((a.cross - b.cross).norm(), 1e-12 * size);
}

template <int N>
void compare_with_unscented(RngStream& draw) {
  const plain::Unscented u{0.3 + 0.7 * draw.uniform(), 3.0 * draw.uniform(), 2.0 * draw.uniform()};
  const Bent<N> model(draw);
  const Vector<N> x = random_vector<N>(draw);
  const auto S = random_factor<N>(draw);
  expect_near<N>(by_rule<N>(unscented_rule(N, u.alpha, u.beta, u.kappa), x, S, model),
                 plain::unscented<3, -1>(x, S, u, model));
}

TEST(SigmaRule, IsTheScaledUnscentedTransformWithItsTextbookWeights) {
  RngStream draw({.seed = 81, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    compare_with_unscented<2>(draw);
    compare_with_unscented<5>(draw);
  }
}

TEST(SigmaRule, IsCentralDifferencesWithTheirTextbookWeights) {
  RngStream draw({.seed = 91, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const double h = 1.1 + draw.uniform();
    const Bent<5> model(draw);
    const Vector<5> x = random_vector<5>(draw);
    const auto S = random_factor<5>(draw);
    const auto image = plain::central_differences<3, -1>(x, S, h, model);
    expect_near<5>(by_rule<5>(central_difference_rule(h), x, S, model),
                   {image.mean, image.A * image.A.transpose() + image.B * image.B.transpose(),
                    S * image.A.transpose()});
  }
}

TEST(SigmaRule, SevenDimensionsWithKappaLessByTwoAreFive) {
  const SigmaRule five = unscented_rule(5, 0.9, 2, 0), seven = unscented_rule(7, 0.9, 2, -2);
  EXPECT_DOUBLE_EQ(five.spread, seven.spread);
  EXPECT_DOUBLE_EQ(five.symmetric, seven.symmetric);
  EXPECT_DOUBLE_EQ(five.shift, seven.shift);
}

TEST(SigmaRule, CentralDifferencesHaveTheVarianceOfAQuadraticAndThePrintHasNot) {
  // EQUATIONS 3: y = a + b x + c x^2 at x ~ N(m, s^2) has variance (b + 2 c m)^2 s^2 + 2 c^2 s^4.
  const double h = std::sqrt(3.0), b = 0.7, c = -0.4, m = 1.3, s = 0.8;
  const double D = (b + 2 * c * m) * h * s, E = c * h * h * s * s;
  const double truth = (b + 2 * c * m) * (b + 2 * c * m) * s * s + 2 * c * c * s * s * s * s;
  const SigmaRule rule = central_difference_rule(h);
  EXPECT_NEAR(rule.antisymmetric * D * D + rule.symmetric * E * E, truth, 1e-15);
  EXPECT_NEAR(rule.mean_weight * E, c * s * s, 1e-15);
  const SigmaRule printed = central_difference_rule_as_printed(h);
  EXPECT_GT(printed.antisymmetric * D * D + printed.symmetric * E * E, truth + 0.1);
  EXPECT_NEAR(printed.mean_weight * E, h * c * s * s, 1e-15);
}

TEST(SigmaRule, ThePrintedWeightsAreThoseOfEquation14) {
  const double h = std::sqrt(3.0), L = 5.0;
  const SigmaRule rule = central_difference_rule_as_printed(h);
  EXPECT_DOUBLE_EQ(rule.mean_weight, 2.0 * (1.0 / (2.0 * h)));              // two points
  EXPECT_DOUBLE_EQ(rule.antisymmetric, 4.0 * (1.0 / (4.0 * h * h)));        // (2 D)^2
  EXPECT_DOUBLE_EQ(rule.symmetric, 4.0 * ((h * h - 1.0) / (4.0 * h * h)));  // (2 E)^2
  const double w0 = (h * h - L) / h, wi = 1.0 / (2.0 * h);
  EXPECT_NEAR(w0 + 2.0 * L * wi, h, 1e-15) << "why the centre's image is not weighed with them";
}

}  // namespace
}  // namespace montecarta::filters
