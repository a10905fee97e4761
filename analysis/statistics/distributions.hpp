// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Probabilities and quantiles of the laws that tests use, computed by Boost.Math. `freedom` is the
/// number of degrees of freedom and need not be whole.
namespace montecarta::analysis {

/// Probability that a standard normal variable is at most z.
double normal_cdf(double z);
double normal_quantile(double probability);

/// Probabilities that a chi-square variable is at most `value` (cdf), and above `value` (tail).
double chi_squared_cdf(double value, double freedom);
double chi_squared_tail(double value, double freedom);
double chi_squared_quantile(double probability, double freedom);
/// The value that a chi-square variable exceeds with probability `tail`.
double chi_squared_beyond(double tail, double freedom);

/// A value may be beyond its gate by this share of it, and is then at the gate.
inline constexpr double kRoundingOfGate = 1e-6;

/// The value that has the probability among all chi-square variables which `value` has among those
/// up to `most`, as a gate lets them pass. At the gate itself it is that of a value which rounding
/// cannot tell from it.
double chi_squared_before_gate(double value, double freedom, double most);

/// The scale at which the law of `scale` times a chi-square variable, of values up to `most`, fits
/// best to values with this mean: the maximum of the likelihood. At most 1000 `most`.
double chi_squared_scale_up_to(double most, double freedom, double mean);

/// Probability that Student's t is at most `t`.
double t_cdf(double t, double freedom);
/// Two-sided p-value of Student's t, or of the normal law if `freedom` is infinite.
double t_p_value(double t, double freedom);
/// The distance from zero that Student's t does not exceed with probability `level`.
double t_score(double level, double freedom);

}  // namespace montecarta::analysis
