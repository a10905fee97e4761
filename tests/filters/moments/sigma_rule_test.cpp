// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/sigma_rule.hpp"

#include "engine/random/stream.hpp"
#include "filters/plain/sigma_points.hpp"

#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

using plain::Image;
using plain::SmallMatrix;
using plain::SmallVector;

SmallMatrix random_matrix(RngStream& draw, Eigen::Index rows, Eigen::Index columns) {
  return SmallMatrix::NullaryExpr(rows, columns, [&](Eigen::Index) { return draw.normal(); });
}
SmallVector random_vector(RngStream& draw, Eigen::Index size) {
  return random_matrix(draw, size, 1);
}

/// A vector of three functions of n variables, bent in all of them.
plain::Model bent(RngStream& draw, Eigen::Index n) {
  const SmallMatrix slope = random_matrix(draw, 3, n), turning_angle = random_matrix(draw, 3, n);
  return {[=](const SmallVector& x) -> SmallVector {
    return slope * x + turning_angle * x.cwiseProduct(x) +
           (turning_angle * x).array().sin().matrix();
  }};
}

/// The moments as SigmaRule promises them.
Image by_rule(const SigmaRule& rule, const SmallVector& x, const SmallMatrix& S,
              const plain::Model& model) {
  const SmallVector centre = model(x);
  SmallVector e = SmallVector::Zero(3);
  Image image{{}, SmallMatrix::Zero(3, 3), SmallMatrix::Zero(x.size(), 3)};
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const SmallVector ahead = x + rule.spread * S.col(j), behind = x - rule.spread * S.col(j);
    const SmallVector D = (model(ahead) - model(behind)) / 2.0;
    const SmallVector E = (model(ahead) + model(behind)) / 2.0 - centre;
    e += rule.mean_weight * E;
    image.covariance += rule.antisymmetric * D * D.transpose();
    image.covariance += rule.symmetric * E * E.transpose();
    image.cross += rule.antisymmetric * rule.spread * S.col(j) * D.transpose();
  }
  image.mean = centre + e;
  image.covariance += rule.shift * e * e.transpose();
  return image;
}

void expect_near(const Image& a, const Image& b) {
  const double size = 1.0 + b.covariance.norm() + b.mean.norm();
  EXPECT_LT((a.mean - b.mean).norm(), 1e-13 * size);
  EXPECT_LT((a.covariance - b.covariance).norm(), 1e-12 * size);
  EXPECT_LT((a.cross - b.cross).norm(), 1e-12 * size);
}

void compare_with_unscented(RngStream& draw, int n) {
  const plain::Unscented u{0.3 + 0.7 * draw.uniform(), 3.0 * draw.uniform(), 2.0 * draw.uniform()};
  const plain::Model model = bent(draw, n);
  const SmallVector x = random_vector(draw, n);
  const SmallMatrix S = 0.3 * random_matrix(draw, n, n);
  expect_near(by_rule(unscented_rule(n, u.alpha, u.beta, u.kappa), x, S, model),
              plain::unscented(x, S, u, model));
}

TEST(SigmaRule, IsTheScaledUnscentedTransformWithItsTextbookWeights) {
  RngStream draw({.seed = 81, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    compare_with_unscented(draw, 2);
    compare_with_unscented(draw, 5);
  }
}

TEST(SigmaRule, IsCentralDifferencesWithTheirTextbookWeights) {
  RngStream draw({.seed = 91, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const double h = 1.1 + draw.uniform();
    const plain::Model model = bent(draw, 5);
    const SmallVector x = random_vector(draw, 5);
    const SmallMatrix S = 0.3 * random_matrix(draw, 5, 5);
    const auto image = plain::central_differences(x, S, h, model);
    expect_near(by_rule(central_difference_rule(h), x, S, model),
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
