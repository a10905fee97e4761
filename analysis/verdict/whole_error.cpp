// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/whole_error.hpp"

#include "analysis/statistics/distributions.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace montecarta::analysis {
namespace {

constexpr double kLeastShare = 0.5;    // of errors that two runs have in common
constexpr double kFewestErrors = 3.0;  // of which a root mean square is taken
constexpr std::size_t kMostKeptRuns = 256;
constexpr double kLeastShareOfSpread = 0.98;  // of errors that two runs have in common
constexpr double kMostSingularSamples = 0.1;
constexpr std::size_t kMostKeptErrors = 8'000'000;  // 64 MB

/// The mean over runs of a number that is zero if the filter is consistent.
void add_zero_mean(Family family, const std::string& name, const Summary& mean,
                   std::vector<MemberTest>& all) {
  if (mean.n < kFewestJudgedRuns) return;
  Member member{.name = name, .estimate = mean.mean};
  const bool is_zero = mean.mean == 0.0 && mean.sd == 0.0;
  member.p = is_zero
                 ? 1.0
                 : t_p_value(mean.mean / mean.standard_error(), static_cast<double>(mean.n) - 1.0);
  all.push_back({family, std::move(member), [mean](double level) { return mean.interval(level); }});
}

/// The deviation of the scales that runs have of their own; only too large a one counts.
MemberTest spread_test(const Summary& variance) {
  const auto root = [](double value) { return std::sqrt(std::max(0.0, value)); };
  Member member{.name = "runs", .estimate = root(variance.mean)};
  const double t = variance.mean / variance.standard_error();
  member.p = t > 0.0 ? 0.5 * t_p_value(t, static_cast<double>(variance.n) - 1.0) : 1.0;
  return {Family::between_runs, std::move(member), [variance, root](double level) {
            const Interval of_variance = variance.interval(level);
            return Interval{root(of_variance.lower), root(of_variance.upper)};
          }};
}

}  // namespace

void AspectProducts::add(const AspectProducts& other) {
  products.add(other.products);
  for (std::size_t run = 0; run < terms_of_run.size(); ++run) {
    terms_of_run[run] += other.terms_of_run[run];
  }
  common_terms += other.common_terms;
  constant_root += other.constant_root;
}

double AspectProducts::terms() const { return mean_of(terms_of_run); }

Traces AspectProducts::traces() const {
  const double largest = constant_root * constant_root;
  if (products.runs() < kFewestRunsOfTraces || !(share() >= kLeastShare)) {
    return traces_of_constant_errors(terms(), largest);
  }
  return traces_of(products, terms(), largest, share());
}

// With all sums in units of t_1: Var z = 2 t_2 (1 + v) + v t_1^2, where v is the variance of the
// scales, and the mean of G_ij^2 is t_2. The factors correct the division of the errors by the
// sample's own root mean square.
Summary AspectProducts::variance_of_scales() const {
  const auto n = static_cast<double>(products.runs());
  const MeanSquaredProduct squares = mean_squared_product(products);
  const double scale = squares.mean + 0.5 * terms() * terms();
  SummaryOf variance;
  for (std::size_t i = 0; i < products.runs(); ++i) {
    const double deviation = products(i, i) - terms_of_run[i];
    const double own = (n + 2.0) / (n - 1.0) * 0.5 * deviation * deviation;
    const double others = (n + 2.0) / n * (n * squares.mean - (n - 1.0) * squares.without[i]);
    variance.add((own - others) / scale);
  }
  return variance.result();
}

DividedErrors::DividedErrors(const ErrorsOfRuns& errors, std::size_t scans, std::size_t dimension)
    : dimension_(dimension),
      errors_(errors),
      counts_(scans * dimension),
      scale_(scans * dimension, kNaN) {
  const std::size_t places = counts_.size();
  std::vector<double> squares(places);
  for (const std::vector<double>& of_run : errors_) {
    expect(of_run.size() == places, "errors are {scan, component}");
    for (std::size_t place = 0; place < places; ++place) {
      if (std::isnan(of_run[place])) continue;
      squares[place] += of_run[place] * of_run[place];
      counts_[place] += 1.0;
    }
  }
  for (std::size_t place = 0; place < places; ++place) {
    double& n = counts_[place];
    if (!(n >= kFewestErrors && squares[place] > 0.0)) n = 0.0;
    if (n > 0.0) scale_[place] = 1.0 / std::sqrt(squares[place] / n);
  }
}

AspectProducts DividedErrors::products(const Aspect& aspect) const {
  AspectProducts found(runs());
  const auto n = static_cast<double>(runs());
  std::vector<std::size_t> places;
  for (std::size_t s = aspect.first_scan; s < aspect.end_scan; ++s) {
    double here = 0.0;
    for (std::size_t k = aspect.first_component; k < aspect.end_component; ++k) {
      const double count = counts_[places.emplace_back(s * dimension_ + k)];
      here += count / n;
      found.common_terms += count * std::max(count - 1.0, 0.0) / (n * (n - 1.0));
    }
    found.constant_root += std::sqrt(here);
  }
  std::vector<double> rows;
  rows.reserve(runs() * places.size());
  for (std::size_t run = 0; run < runs(); ++run) {
    for (const std::size_t place : places) {
      const double error = errors_[run][place] * scale_[place];
      const bool is_there = !std::isnan(error);
      rows.push_back(is_there ? error : 0.0);
      found.terms_of_run[run] += is_there ? 1.0 : 0.0;
    }
  }
  found.products.add(rows, places.size());
  return found;
}

void WholeError::Sum::add(double error) {
  if (std::isnan(error)) return;
  squares += error * error;
  terms += 1.0;
  terms_of_run += 1.0;
}

void WholeError::Sum::end_run() {
  squared_terms += terms_of_run * terms_of_run;
  terms_of_run = 0.0;
}

WholeError::WholeError(std::size_t dimension, std::size_t scans)
    : dimension_(dimension),
      scans_(scans),
      stretches_(scans < 2 * kStretches ? 1 : kStretches),
      component_(dimension),
      stretch_(stretches_),
      nees_(scans),
      bias_(dimension),
      correlation_(dimension * (dimension - 1) / 2) {}

void WholeError::add(const WhitenedRun& run, std::span<const double> nees) {
  expect(run.dimension == dimension_ && run.whitened.size() == scans_ * dimension_,
         "errors are {scan, component}");
  for (std::size_t s = 0; s < scans_; ++s) {
    nees_.add(s, nees[s], static_cast<double>(dimension_));
  }
  if (std::ranges::all_of(run.whitened, [](double u) { return std::isnan(u); })) return;
  ++runs_;
  add_squares(run);
  add_means(run);
  if (whitened_.size() == most_kept_runs()) return;
  whitened_.push_back(run.whitened);
  standardised_.push_back(run.standardised);
}

std::size_t WholeError::most_kept_runs() const {
  const std::size_t length = std::max<std::size_t>(scans_ * dimension_, 1);
  return std::clamp(kMostKeptErrors / length, kFewestRunsOfSpread, kMostKeptRuns);
}

void WholeError::add_squares(const WhitenedRun& run) {
  for (std::size_t s = 0; s < scans_; ++s) {
    const auto errors = std::span(run.whitened).subspan(s * dimension_, dimension_);
    const bool has_any = std::ranges::any_of(errors, [](double u) { return !std::isnan(u); });
    whole_samples_ += has_any ? 1.0 : 0.0;
  }
  Sum size = size_;  // registers add faster than memory
  for (std::size_t stretch = 0; stretch < stretches_; ++stretch) {
    Sum sum = stretch_[stretch];
    for (std::size_t s = first_scan(stretch); s < first_scan(stretch + 1); ++s) {
      for (std::size_t k = 0; k < dimension_; ++k) {
        size.add(run.whitened[s * dimension_ + k]);
        sum.add(run.whitened[s * dimension_ + k]);
        component_[k].add(run.standardised[s * dimension_ + k]);
      }
    }
    sum.end_run();
    stretch_[stretch] = sum;
  }
  size.end_run();
  size_ = size;
  for (Sum& sum : component_) sum.end_run();
}

void WholeError::add_means(const WhitenedRun& run) {
  struct Mean {
    double sum = 0.0, n = 0.0;
    void add(double value) {
      if (std::isnan(value)) return;
      sum += value;
      n += 1.0;
    }
    void end_run(SummaryOf& means) const {
      if (n > 0.0) means.add(sum / n);
    }
  };
  std::vector<Mean> bias(bias_.size()), correlation(correlation_.size());
  for (std::size_t at = 0; at < scans_ * dimension_; at += dimension_) {
    auto pair = correlation.begin();
    for (std::size_t a = at; a < at + dimension_; ++a) {
      bias[a - at].add(run.standardised[a]);
      for (std::size_t b = a + 1; b < at + dimension_; ++b) {
        (pair++)->add(run.whitened[a] * run.whitened[b]);
      }
    }
  }
  for (std::size_t a = 0; a < bias.size(); ++a) bias[a].end_run(bias_[a]);
  for (std::size_t p = 0; p < correlation.size(); ++p) correlation[p].end_run(correlation_[p]);
}

/// Returns whether at most a tenth of the samples have a singular covariance. Otherwise the size is
/// judged by the NEES as well, which those samples have too.
bool WholeError::are_most_samples_whole() const {
  double judged = 0.0;
  for (const SummedError::Scan& scan : nees_.scans()) judged += scan.runs;
  return whole_samples_ >= (1.0 - kMostSingularSamples) * judged;
}

void WholeError::add_variances(const ErrorNames& names, const DividedErrors& whitened,
                               std::vector<MemberTest>& all) const {
  AspectProducts size(whitened.runs());
  for (std::size_t s = 0; s < stretches_; ++s) {
    const std::size_t first = first_scan(s), end = first_scan(s + 1);
    const AspectProducts found = whitened.products({first, end, 0, dimension_});
    size.add(found);
    if (stretches_ == 1 || !(found.terms() > 0.0)) continue;
    Member member{.from = names.times[first], .to = names.times[end - 1]};
    member.estimate = stretch_[s].ratio();
    all.push_back(
        ratio_test(Family::stretch, member, SquaresLaw(found.traces(), stretch_[s].runs())));
  }
  if (!(size.terms() > 0.0)) return;
  if (!are_most_samples_whole()) all.push_back(nees_.size_test());
  all.push_back(ratio_test(Family::size, {.name = "all", .estimate = size_.ratio()},
                           SquaresLaw(size.traces(), size_.runs())));
  add_components(names, all);
  // Runs without all samples vary more between each other than the products of two of them show.
  const bool are_alike = size.share() > kLeastShareOfSpread;
  if (are_alike && whitened.runs() >= kFewestRunsOfSpread) {
    all.push_back(spread_test(size.variance_of_scales()));
  }
}

void WholeError::add_components(const ErrorNames& names, std::vector<MemberTest>& all) const {
  if (dimension_ == 1) return;
  const DividedErrors errors(standardised_, scans_, dimension_);
  for (std::size_t k = 0; k < dimension_; ++k) {
    const AspectProducts found = errors.products({0, scans_, k, k + 1});
    if (!(found.terms() > 0.0)) continue;
    Member member{.name = names.components[k], .estimate = component_[k].ratio()};
    const SquaresLaw law(found.traces(), component_[k].runs());
    all.push_back(ratio_test(Family::component, std::move(member), law));
  }
}

void WholeError::add_means(const ErrorNames& names, std::vector<MemberTest>& all) const {
  for (std::size_t a = 0; a < dimension_; ++a) {
    add_zero_mean(Family::bias, names.components[a], bias_[a].result(), all);
  }
  std::size_t pair = 0;
  for (std::size_t a = 0; a < dimension_; ++a) {
    for (std::size_t b = a + 1; b < dimension_; ++b) {
      add_zero_mean(Family::correlation, names.components[a] + " and " + names.components[b],
                    correlation_[pair++].result(), all);
    }
  }
}

std::vector<FamilyTest> WholeError::families(double level, const ErrorNames& names) const {
  if (runs_ < kFewestJudgedRuns) {
    return nees_.most_runs() < kFewestJudgedRuns ? std::vector<FamilyTest>{}
                                                 : nees_.families(level, names.times);
  }
  std::vector<MemberTest> all = nees_.scan_tests(names.times);
  add_variances(names, DividedErrors(whitened_, scans_, dimension_), all);
  add_means(names, all);
  return judge_tests(std::move(all), level);
}

}  // namespace montecarta::analysis
