// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

namespace montecarta::filters {

/// The coefficients of a sigma-point transform (EQUATIONS (3.8), with the same letters). Points lie
/// in pairs at centre +- spread times a column of the square root. With Y0 the image of the centre,
/// and D = (Y+ - Y-)/2 and E = (Y+ + Y-)/2 - Y0 of every pair, the moments of the image are
///   mean = Y0 + e with e = mean_weight sum E,
///   covariance = sum of (antisymmetric D D' + symmetric E E') + shift e e',
///   cross-covariance = antisymmetric spread sum of (column D').
/// A column along which the model is linear has E = 0 and spread D D' antisymmetric = column
/// column', so that its points need not be sent through the model.
struct SigmaRule {
  double spread;         ///< rho: distance of the points in standard deviations
  double mean_weight;    ///< m: weight of E in the mean
  double antisymmetric;  ///< a: weight of D D' in the covariance
  double symmetric;      ///< q: weight of E E' in the covariance
  double shift;          ///< t: weight of e e' in the covariance
};

/// Scaled unscented transform in `n` dimensions (EQUATIONS (3.3), (3.4)): spread^2 = n + lambda =
/// alpha^2 (n + kappa). Summed by pairs, the weights w0 = lambda/(n + lambda), wc0 = w0 + 1 -
/// alpha^2 + beta and wi = 1/(2(n + lambda)) leave beta - alpha^2 for e e'.
SigmaRule unscented_rule(double n, double alpha, double beta, double kappa);

/// Central differences with interval h (EQUATIONS (3.5)); h^2 is the kurtosis of the prior, 3 for a
/// Gaussian.
SigmaRule central_difference_rule(double h);

/// The weights that Ankishan eq. (14) prints: (h^2 - L)/h, 1/(2h), 1/(4h^2), (h^2 - 1)/(4h^2). The
/// first two sum to h instead of one. Here they are weights of deviations from Y0; otherwise every
/// step would multiply a pose far from the origin by sqrt(3) (EQUATIONS 3).
SigmaRule central_difference_rule_as_printed(double h);

}  // namespace montecarta::filters
