// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/gate_scale.hpp"

#include "analysis/statistics/distributions.hpp"

#include <boost/math/quadrature/tanh_sinh.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace montecarta::analysis {
namespace {

constexpr double kLeastFactor = 1.0 / GateScale::kMostFactor;
constexpr double kStepsPerOctave = 16.0;
constexpr double kStep = 1.0 / kStepsPerOctave;  // of the logarithm to the base 2

/// Mean of the corrected NIS of rows that passed their limit, for each component.
double shown_by(const GatedRows& rows, double factor) {
  const double n = rows.components;
  const double passed = chi_squared_cdf(rows.limit / factor, n);
  const auto corrected = [&](double probability) {
    const double nis = factor * chi_squared_quantile(probability * passed, n);
    return chi_squared_before_gate(nis, n, rows.limit);
  };
  constexpr double kTolerance = 1e-7;
  boost::math::quadrature::tanh_sinh<double> integrator(9);
  return integrator.integrate(corrected, 0.0, 1.0, kTolerance) / n;
}

}  // namespace

bool GatedRows::is_usable() const {
  return count >= 1.0 && count < 1e15 && components >= 1.0 && components < kMostComponents &&
         limit > kLeastLimit && limit < kMostLimit;
}

GateScale::GateScale(const std::vector<GatedRows>& rows) : rows_(rows) {
  const auto steps = static_cast<int>(2.0 * std::log2(kMostFactor) * kStepsPerOctave);
  for (int step = 0; step <= steps; ++step) {
    log_shown_.push_back(std::log2(shown(kLeastFactor * std::exp2(kStep * step))));
  }
  log_shown_[static_cast<std::size_t>(steps) / 2] = 0.0;  // of the right covariance, exactly
  constexpr double kLeastGrowth = 1e-9;                   // where rounding hides it
  for (std::size_t k = 1; k < log_shown_.size(); ++k) {
    log_shown_[k] = std::max(log_shown_[k], log_shown_[k - 1] + kLeastGrowth);
  }
}

double GateScale::shown(double factor) const {
  double sum = 0.0, components = 0.0;
  for (const GatedRows& rows : rows_) {
    sum += rows.count * rows.components * shown_by(rows, factor);
    components += rows.count * rows.components;
  }
  return sum / components;
}

double GateScale::factor_of(double ratio) const {
  if (std::isnan(ratio)) return ratio;
  const double wanted = std::log2(ratio);
  if (wanted >= log_shown_.back()) return kMostFactor;
  if (wanted <= log_shown_.front()) return kLeastFactor * ratio / std::exp2(log_shown_.front());
  const auto next = std::ranges::upper_bound(log_shown_, wanted);
  const double above = *next, below = *(next - 1);
  const double place = static_cast<double>(next - 1 - log_shown_.begin());
  return kLeastFactor * std::exp2(kStep * (place + (wanted - below) / (above - below)));
}

Interval GateScale::factor_of(const Interval& ratio) const {
  const double upper = factor_of(ratio.upper);
  return {factor_of(ratio.lower),
          upper >= kMostFactor ? std::numeric_limits<double>::infinity() : upper};
}

void GateScale::put_factors(std::vector<FamilyTest>& families) const {
  for (FamilyTest& test : families) {
    if (!is_ratio(test.family)) continue;
    for (Member& member : test.members) {
      member.estimate = factor_of(member.estimate);
      for (Interval* one : {&member.interval, &member.simultaneous, &member.shown}) {
        if (!std::isnan(one->lower)) *one = factor_of(*one);
      }
    }
  }
}

std::optional<GateScale> gate_scale_of(const std::string& limits) {
  std::vector<GatedRows> rows;
  for (std::size_t begin = 0; begin < limits.size();) {
    const std::size_t end = std::min(limits.find(", ", begin), limits.size());
    GatedRows one;
    std::istringstream text(limits.substr(begin, end - begin));
    std::string word;
    text >> one.count >> word >> word >> one.components >> word >> word >> one.limit;
    if (!text || !one.is_usable()) return std::nullopt;
    rows.push_back(one);
    begin = end + 2;
  }
  if (rows.empty()) return std::nullopt;
  return GateScale(rows);
}

}  // namespace montecarta::analysis
