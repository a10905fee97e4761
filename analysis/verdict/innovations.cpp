// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/innovations.hpp"

#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "engine/errors.hpp"

#include <boost/math/special_functions/gamma.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace montecarta::analysis {
namespace {

// Number of lags, from lag 0 on, rounded up to whole registers.
constexpr std::size_t kLagsTogether = 24;

static_assert(kInnovationLags < kLagsTogether);

/// Components count with at most so many deviations, so that no single one hides how the others go
/// together.
constexpr double kFarthest = 5.0;

/// The level of each test, if `lags` lags of the NIS and of each component, and the mean of each
/// component, are judged together (Sidak).
double level_of_each(std::size_t lags, std::size_t components, double level) {
  const auto tests = static_cast<double>(lags * (1 + components) + components);
  return std::pow(level, 1.0 / tests);
}

/// The number of standard deviations that white normal numbers do not exceed at this level.
double white_deviate(double level) { return normal_quantile(0.5 + 0.5 * level); }

/// The same of the correlation over so many pairs of numbers with this skewness, by which the mean
/// of their products has a long tail (STATISTICS (9.2)).
double white_deviate_of_nis(double level, double pairs, double skewness) {
  constexpr double kFewest = 40.0;  // fewer pairs have no long tail
  const double of_mean =
      std::max(0.0, 1.0 - kFewest / pairs) * skewness * skewness / std::sqrt(pairs);
  const double z = white_deviate(level);
  return z + of_mean * (z * z - 1.0) / 6.0;
}

/// Two thirds powers of chi-square variables with the same numbers of degrees of freedom again and
/// again, less their means, in their deviations.
class StandardisedNis {
 public:
  double operator()(double nis, std::uint32_t dof) {
    const auto [found, is_new] = laws_.try_emplace(dof);
    if (is_new) {
      found->second.mean = moment(dof, 2.0 / 3.0);
      found->second.deviation =
          std::sqrt(moment(dof, 4.0 / 3.0) - found->second.mean * found->second.mean);
    }
    const double root = std::cbrt(nis);
    return (root * root - found->second.mean) / found->second.deviation;
  }

 private:
  struct Law {
    double mean = 0.0, deviation = 1.0;
  };
  /// Expectation of a power of a chi-square variable.
  static double moment(std::uint32_t dof, double power) {
    return std::pow(2.0, power) / boost::math::tgamma_delta_ratio(0.5 * dof, power);
  }

  std::map<std::uint32_t, Law> laws_;
};

bool is_innovation(double nis, std::uint32_t dof) {
  return dof > 0 && nis >= 0.0 && std::isfinite(nis);
}

/// The normal score of a chi-square variable (Wilson and Hilferty 1931), also where its tail is too
/// small for a double.
double normal_deviate(double chi_square, double freedom) {
  const double variance = 2.0 / (9.0 * freedom);
  return (std::cbrt(chi_square / freedom) - (1.0 - variance)) / std::sqrt(variance);
}

bool is_off(Answer answer) {
  return answer == Answer::optimistic || answer == Answer::conservative ||
         answer == Answer::inconsistent;
}

}  // namespace

void LaggedProducts::add(std::span<const double> numbers) {
  numbers_.clear();
  for (std::size_t s = numbers.size(); s-- > 0;) {  // the last one comes first: earlier ones follow
    if (std::isnan(numbers[s])) continue;
    numbers_.push_back(numbers[s]);
    cubes_ += numbers[s] * numbers[s] * numbers[s];
  }
  const std::size_t count = numbers_.size();
  is_there_.assign(count, 1.0);
  numbers_.resize(count + kLagsTogether, 0.0);
  is_there_.resize(numbers_.size(), 0.0);
  std::array<double, kLagsTogether> n{}, both{}, product{};
  for (std::size_t place = count; place-- > 0;) {
    const double* const earlier = numbers_.data() + place;
    const double* const is_there = is_there_.data() + place;
    for (std::size_t lag = 0; lag < kLagsTogether; ++lag) {
      n[lag] += is_there[lag];
      both[lag] += is_there[lag] * (*earlier + earlier[lag]);
      product[lag] += *earlier * earlier[lag];
    }
  }
  for (std::size_t lag = 0; lag < products_.size(); ++lag) {
    products_[lag].n += n[lag];
    products_[lag].both += both[lag];
    products_[lag].product += product[lag];
  }
}

std::size_t LaggedProducts::lags(std::uint64_t runs) const {
  if (runs == 0) return 0;
  const auto of_run = static_cast<std::size_t>(products_[0].n / static_cast<double>(runs));
  return std::min(products_.size() - 1, of_run / 4);
}

double LaggedProducts::correlation(std::size_t lag) const {
  const double power = products_[0].mean_product(mean());
  if (products_[lag].n == 0.0 || !(power > 0.0)) return kNaN;
  return products_[lag].mean_product(mean()) / power;
}

double LaggedProducts::skewness() const {
  const double n = products_[0].n, m = mean(), power = products_[0].mean_product(m);
  const double third = cubes_ / n - 3.0 * m * products_[0].product / n + 2.0 * m * m * m;
  const double found = third / power / std::sqrt(power);
  return std::isfinite(found) ? found : std::sqrt(n);  // that of numbers one of which is huge
}

InnovationSums::Totals::Totals(std::size_t scans)
    : nis_(scans), products_(scans), spreads_(ends_of_stretches(scans).size()) {}

void InnovationSums::Totals::add(std::span<const double> nis, std::span<const std::uint32_t> dof) {
  std::vector<double> there(nis.begin(), nis.end());
  for (std::size_t s = 0; s < nis.size(); ++s) {
    if (!is_innovation(nis[s], dof[s])) there[s] = kNaN;
  }
  nis_.add(there, std::vector<double>(dof.begin(), dof.end()));
  const std::vector<std::size_t> ends = ends_of_stretches(nis_.scans().size());
  for (std::size_t s = 0, stretch = 0; s < there.size(); ++s) {
    if (s == ends[stretch]) ++stretch;
    if (!std::isnan(there[s])) spreads_[stretch].add(there[s], dof[s]);
  }
  StandardisedNis standardised;
  for (std::size_t s = 0; s < there.size(); ++s) {
    if (!std::isnan(there[s])) there[s] = standardised(there[s], dof[s]);
  }
  products_.add(there);
}

void InnovationSums::add(std::uint64_t run, std::span<const double> times,
                         std::span<const double> nis, std::span<const std::uint32_t> dof,
                         std::span<const double> standardised) {
  if (largest_ && measurements_ == Measurements::same) return;
  const std::size_t d = components_.size();
  std::vector<double> component(standardised.empty() ? 0 : nis.size());
  for (std::size_t k = 0; k < d && !standardised.empty(); ++k) {
    for (std::size_t s = 0; s < component.size(); ++s) {
      component[s] = std::clamp(standardised[s * d + k], -kFarthest, kFarthest);
    }
    components_[k].add(component);
  }
  std::optional<LargestRun> next;
  for (std::size_t s = 0; s < nis.size(); ++s) {
    if (!is_innovation(nis[s], dof[s])) continue;
    const double deviate = normal_deviate(nis[s], dof[s]);
    if (next && deviate <= next->deviate) continue;
    next = {.deviate = deviate, .run = run, .scan = s, .time = times[s], .nis = {}, .dof = {}};
  }
  if (!next) return;
  if (largest_ && next->deviate <= largest_->deviate) return others_.add(nis, dof);
  if (largest_) others_.add(largest_->nis, largest_->dof);
  next->nis.assign(nis.begin(), nis.end());
  next->dof.assign(dof.begin(), dof.end());
  largest_.swap(next);
}

void InnovationSums::merge(InnovationSums& next) {
  if (largest_ && measurements_ == Measurements::same) return;
  merge_into(others_, next.others_);
  merge_into(components_, next.components_);
  if (!next.largest_) return;
  if (!largest_) return largest_.swap(next.largest_);
  if (next.largest_->deviate > largest_->deviate) largest_.swap(next.largest_);
  others_.add(next.largest_->nis, next.largest_->dof);
}

Innovations InnovationSums::result(std::span<const double> times, double level, double within,
                                   const GateScale* gate) const {
  expect(largest_.has_value() && largest_->scan < largest_->dof.size() &&
             largest_->nis.size() == largest_->dof.size(),
         "an innovation of a scan");
  Totals all = others_, without = others_;
  all.add(largest_->nis, largest_->dof);
  std::vector<std::uint32_t> dof = largest_->dof;
  dof[largest_->scan] = 0;
  without.add(largest_->nis, dof);
  const auto components = correlated_components(all.runs(), level);
  Innovations result = all.result(times, level, within, gate, components);
  const Innovations rest = without.result(times, level, within, gate, components);
  result.largest = {.nis = largest_->nis[largest_->scan],
                    .dof = static_cast<double>(largest_->dof[largest_->scan]),
                    .run = largest_->run,
                    .time = largest_->time,
                    .origin = origin_of(times),
                    .ratio_without = rest.ratio,
                    .whiteness_without = rest.whiteness_of_nis(),
                    .answer_without = rest.verdict.answer};
  return result;
}

std::vector<ComponentCorrelation> InnovationSums::correlated_components(std::uint64_t runs,
                                                                        double level) const {
  std::vector<ComponentCorrelation> all(components_.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k].mean = components_[k].mean();
    const std::size_t lags = components_[k].lags(runs);
    const double deviate = white_deviate(level_of_each(lags, all.size(), level));
    all[k].mean_bound = deviate / std::sqrt(components_[k].pairs(0));
    for (std::size_t lag = 1; lag <= lags; ++lag) {
      const ComponentCorrelation one{.lag = lag,
                                     .correlation = components_[k].correlation(lag),
                                     .bound = deviate / std::sqrt(components_[k].pairs(lag))};
      const double distance = std::abs(one.correlation) / one.bound;
      if (all[k].lag > 0 && distance <= std::abs(all[k].correlation) / all[k].bound) continue;
      all[k].lag = one.lag;
      all[k].correlation = one.correlation;
      all[k].bound = one.bound;
    }
  }
  return all;
}

Innovations InnovationSums::Totals::result(std::span<const double> times, double level,
                                           double within, const GateScale* gate,
                                           std::vector<ComponentCorrelation> components) const {
  Innovations result;
  result.components = std::move(components);
  double tested = 0.0, inside = 0.0;
  for (const SummedError::Scan& scan : nis_.scans()) {
    const auto freedom = static_cast<std::uint64_t>(scan.dimensions);
    result.average.push_back(scan.ratio());  // NaN if there is none
    result.bounds.push_back(freedom == 0 ? Interval{} : nees_bounds(freedom, 1, level));
    if (freedom == 0) continue;
    const Interval& band = result.bounds.back();
    tested += 1.0;
    inside += band.lower <= scan.ratio() && scan.ratio() <= band.upper ? 1.0 : 0.0;
  }
  result.share_inside = inside / tested;
  find_correlations(level, result);
  judge_size(times, level, within, gate, result);
  return result;
}

void InnovationSums::Totals::find_correlations(double level, Innovations& result) const {
  result.autocorrelation.assign(kInnovationLags, kNaN);
  result.white_bound.assign(kInnovationLags, kNaN);
  const std::size_t lags = products_.lags(runs());
  const double each = level_of_each(lags, result.components.size(), level);
  const double skewness = products_.skewness();
  double farthest = 0.0;
  for (std::size_t lag = 1; lag <= lags; ++lag) {
    const double correlation = products_.correlation(lag);
    if (std::isnan(correlation)) continue;
    const double pairs = products_.pairs(lag);
    const double bound = white_deviate_of_nis(each, pairs, skewness) / std::sqrt(pairs);
    result.autocorrelation[lag - 1] = correlation;
    result.white_bound[lag - 1] = bound;
    if (result.worst_lag > 0 && std::abs(correlation) / bound <= farthest) continue;
    farthest = std::abs(correlation) / bound;
    result.worst_lag = lag;
  }
}

void InnovationSums::Totals::judge_size(std::span<const double> times, double level, double within,
                                        const GateScale* gate, Innovations& result) const {
  std::vector<FamilyTest> families;
  if (result.whiteness() != Whiteness::not_white) {
    families = nis_.white_families(level, times, spreads_);
  } else if (runs() >= kFewestRunsOfSize) {
    families = judge_tests({nis_.size_test()}, level);
  }
  if (gate != nullptr) gate->put_factors(families);
  result.verdict = judge(std::move(families), level, within, runs());
  double sum = 0.0, freedom = 0.0;
  for (const SummedError::Scan& scan : nis_.scans()) {
    sum += scan.nees;
    freedom += scan.dimensions;
  }
  const double judged = result.verdict.ratio_estimate();
  const double given = sum / freedom, ratio = gate == nullptr ? given : gate->factor_of(given);
  result.ratio = std::isnan(judged) ? ratio : judged;
}

Whiteness Innovations::whiteness() const {
  const bool are_white = std::ranges::all_of(components, &ComponentCorrelation::is_white);
  return are_white ? whiteness_of_nis() : Whiteness::not_white;
}

Whiteness Innovations::whiteness_of_nis() const {
  if (worst_lag == 0) return Whiteness::untested;
  const bool is_white = std::abs(autocorrelation[worst_lag - 1]) <= white_bound[worst_lag - 1];
  return is_white ? Whiteness::white : Whiteness::not_white;
}

bool Innovations::are_decided_by_largest() const {
  if (std::isnan(largest.ratio_without)) return false;
  return whiteness_of_nis() != largest.whiteness_without ||
         (judges_size() && is_off(verdict.answer) != is_off(largest.answer_without));
}

std::string whiteness_in_words(Whiteness whiteness, std::optional<Answer> size) {
  const char* const text = whiteness == Whiteness::untested ? "whiteness not tested"
                           : whiteness == Whiteness::white  ? "white"
                                                            : "not white";
  if (!size) return text;
  if (*size == Answer::untested) return std::string(text) + ", size not judged";
  return std::string(text) + (whiteness == Whiteness::not_white ? ", size " : ", ") +
         name_of(*size);
}

std::string whiteness_in_words(const Innovations& found) {
  const Answer size = found.verdict.answer;
  return whiteness_in_words(found.whiteness(),
                            found.judges_size() ? std::optional(size) : std::nullopt);
}

std::string whiteness_without_largest(const Innovations& found) {
  const Answer size = found.largest.answer_without;
  return whiteness_in_words(found.largest.whiteness_without,
                            found.judges_size() ? std::optional(size) : std::nullopt);
}

}  // namespace montecarta::analysis
