// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/bets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

/// The least stake. Stakes are powers of two: a stake between two of them would grow at most a
/// tenth faster.
constexpr double kLeastStake = 1.0 / 64.0;
constexpr std::size_t kStakesBelow = 8;  // number of stakes, up to 2
// Number of standard errors added to the estimated variance.
constexpr double kErrorsOfVariance = 2.0;
constexpr double kLeastVariance = 1e-4;  // least variance that sums of powers in doubles resolve
// Smaller means of runs count as this one, so that their fourth powers are not 0.
constexpr double kLeastMeanOfRun = 1e-60;
constexpr double kVarianceOfOneError = 2.0;  // variance of the square of a Gaussian error

double stake(std::size_t index) { return std::ldexp(kLeastStake, static_cast<int>(index)); }

/// Logarithm of the mean of numbers with these logarithms.
double log_mean(std::span<const double> logarithms) {
  if (logarithms.empty()) return -std::numeric_limits<double>::infinity();
  const double largest = std::ranges::max(logarithms);
  if (!std::isfinite(largest)) return largest;
  double sum = 0.0;
  for (const double one : logarithms) sum += std::exp(one - largest);
  return largest + std::log(sum / static_cast<double>(logarithms.size()));
}

}  // namespace

double largest_mean_exponential(double s, double variance) {
  const double square = 1.0 + variance;  // mean of m^2
  return (variance + std::exp(-s * square)) / square;
}

void Bets::add(double mean_of_run) {
  if (std::isnan(mean_of_run)) return;
  mean_of_run = std::max(mean_of_run, kLeastMeanOfRun);
  ++runs_;
  for (std::size_t j = 0; j < kStakes; ++j) growth_[j] += std::log1p(stake(j) * mean_of_run);
  double power = 1.0;
  for (double& sum : powers_) sum += power *= mean_of_run;
}

double Bets::log_capital(Side side, double margin) const {
  return side == Side::above ? log_capital_above(margin) : log_capital_below(margin);
}

double Bets::log_capital_above(double margin) const {
  std::array<double, kStakes> capitals{};
  for (std::size_t j = 0; j < kStakes; ++j) {
    capitals[j] = growth_[j] - static_cast<double>(runs_) * std::log1p(stake(j) * margin);
  }
  return log_mean(capitals);
}

double Bets::log_capital_below(double margin) const {
  if (runs_ < kFewestRuns) return 0.0;
  const double variance = safe_variance();
  std::array<double, kStakesBelow> capitals{};
  for (std::size_t j = 0; j < kStakesBelow; ++j) {
    const double s = stake(j) / variance;
    const double fair = std::log(largest_mean_exponential(s, variance));
    capitals[j] = -s * margin * powers_[0] - static_cast<double>(runs_) * fair;
  }
  return log_mean(capitals);
}

/// Variance of the means of runs in units of their squared expectation: the estimate plus
/// kErrorsOfVariance standard errors, which follow from the first four moments.
double Bets::safe_variance() const {
  const auto n = static_cast<double>(runs_);
  const double mean = powers_[0] / n;
  if (!(mean > 0.0)) return kVarianceOfOneError;
  const double a2 = powers_[1] / n / (mean * mean);
  const double a3 = powers_[2] / n / (mean * mean * mean);
  const double a4 = powers_[3] / n / (mean * mean * mean * mean);
  const double v = a2 - 1.0, third = a3 - 3.0 * a2 + 2.0;
  const double fourth = a4 - 4.0 * a3 + 6.0 * a2 - 3.0;
  const double of_estimate = (fourth - v * v - 4.0 * v * third + 4.0 * v * v * v) / n;
  const double safe = v * n / (n - 1.0) + kErrorsOfVariance * std::sqrt(std::max(0.0, of_estimate));
  return std::max(safe, kLeastVariance);
}

double log_capital(FamiliesOfBets families, Side side, double margin) {
  std::vector<double> of_families;
  for (const std::vector<Bets>& members : families) {
    std::vector<double> capitals;
    for (const Bets& bets : members) capitals.push_back(bets.log_capital(side, margin));
    if (!capitals.empty()) of_families.push_back(log_mean(capitals));
  }
  return log_mean(of_families);
}

std::optional<Side> refused_side(FamiliesOfBets families, double margin, double level) {
  const std::array capitals = {log_capital(families, Side::above, margin),
                               log_capital(families, Side::below, margin)};
  if (!(log_mean(capitals) >= -std::log(1.0 - level))) return std::nullopt;
  return capitals[0] > capitals[1] ? Side::above : Side::below;
}

}  // namespace montecarta::analysis
