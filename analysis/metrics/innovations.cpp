// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/innovations.hpp"

#include "analysis/statistics/bootstrap.hpp"
#include "analysis/statistics/means.hpp"

#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

/// Sums over pairs of scans `lag` apart that both have innovations.
struct Products {
  double sum = 0.0;
  double n = 0.0;
};

Products products_at(std::span<const double> values, std::size_t lag) {
  Products products;
  for (std::size_t s = lag; s < values.size(); ++s) {
    const double product = values[s] * values[s - lag];
    if (std::isnan(product)) continue;
    products.sum += product;
    products.n += 1.0;
  }
  return products;
}

void subtract_mean(std::vector<double>& values) {
  const double mean = mean_of_finite(values);
  for (double& value : values) value -= mean;
}

/// What white innovations stay below at all lags.
double white_bound(const std::vector<double>& pairs, double level) {
  const double each = std::pow(level, 1.0 / static_cast<double>(pairs.size()));
  const double deviate = boost::math::quantile(boost::math::normal(), 0.5 + 0.5 * each);
  return deviate / std::sqrt(*std::ranges::min_element(pairs));
}

}  // namespace

InnovationSums::InnovationSums(std::size_t scans)
    : nis_(scans), dof_(scans), correlations_(kInnovationLags), pairs_(kInnovationLags) {}

void InnovationSums::add(std::span<const double> nis, std::span<const std::uint32_t> dof) {
  double sum = 0.0, freedom = 0.0;
  deviations_.assign(nis.size(), kNaN);
  for (std::size_t s = 0; s < nis.size(); ++s) {
    if (dof[s] == 0 || !std::isfinite(nis[s])) continue;
    const double n = dof[s];
    nis_[s] += nis[s];
    dof_[s] += dof[s];
    sum += nis[s];
    freedom += n;
    deviations_[s] = (nis[s] - n) / std::sqrt(2.0 * n);
  }
  if (freedom == 0.0) return;
  run_means_.push_back(sum / freedom);
  subtract_mean(deviations_);
  const Products power = products_at(deviations_, 0);
  for (std::size_t lag = 1; lag <= kInnovationLags; ++lag) {
    const Products products = products_at(deviations_, lag);
    if (products.n == 0.0 || power.sum == 0.0) continue;
    correlations_[lag - 1] += products.sum / power.sum * power.n / products.n;
    pairs_[lag - 1] += products.n;
  }
}

Innovations InnovationSums::result(double level) const {
  Innovations result;
  double tested = 0.0, inside = 0.0;
  for (std::size_t s = 0; s < nis_.size(); ++s) {
    const auto n = static_cast<double>(dof_[s]);
    result.average.push_back(nis_[s] / n);  // NaN where there is none
    result.bounds.push_back(dof_[s] == 0 ? Interval{} : nees_bounds(dof_[s], 1, level));
    if (dof_[s] == 0) continue;
    const Interval& band = result.bounds.back();
    tested += 1.0;
    inside += band.lower <= result.average[s] && result.average[s] <= band.upper ? 1.0 : 0.0;
  }
  const auto runs = static_cast<double>(run_means_.size());
  for (const double mean : run_means_) result.mean += mean / runs;
  for (const double sum : correlations_) result.autocorrelation.push_back(sum / runs);
  result.share_inside = inside / tested;
  result.interval = bootstrap_mean(run_means_, level);
  result.bound = white_bound(pairs_, level);
  result.white = std::ranges::all_of(result.autocorrelation,
                                     [&](double r) { return std::abs(r) <= result.bound; });
  return result;
}

}  // namespace montecarta::analysis
