// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/sigma_rule.hpp"

#include <cmath>

namespace montecarta::filters {

SigmaRule unscented_rule(double n, double alpha, double beta, double kappa) {
  const double square = alpha * alpha * (n + kappa);
  return {.spread = std::sqrt(square),
          .mean_weight = 1.0 / square,
          .antisymmetric = 1.0 / square,
          .symmetric = 1.0 / square,
          .shift = beta - alpha * alpha};
}

SigmaRule central_difference_rule(double h) {
  const double square = h * h;
  return {.spread = h,
          .mean_weight = 1.0 / square,
          .antisymmetric = 1.0 / square,                    // 4 wc1
          .symmetric = (square - 1.0) / (square * square),  // 4 wc2
          .shift = 0.0};
}

SigmaRule central_difference_rule_as_printed(double h) {
  SigmaRule rule = central_difference_rule(h);
  rule.mean_weight = 1.0 / h;
  rule.symmetric = (h * h - 1.0) / (h * h);
  return rule;
}

}  // namespace montecarta::filters
