// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/whole_error.hpp"

#include "analysis/statistics/distributions.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

namespace montecarta::analysis {
namespace {

/// Laws of the ratio of single scans by their degrees of freedom, which are nearly always the same.
class ScanLaws {
 public:
  double p_value(double freedom, double ratio) { return law(freedom).p_value(ratio); }
  Interval interval(double freedom, double ratio, double level) {
    const auto [found, is_new] = intervals_.try_emplace({freedom, level});
    if (is_new) found->second = law(freedom).interval(1.0, level);
    return {ratio * found->second.lower, ratio * found->second.upper};
  }

 private:
  /// The exact law: so many squares of independent standard normal variables.
  const SquaresLaw& law(double freedom) {
    return laws_.try_emplace(freedom, Traces{1.0, 1.0, 1.0}, freedom).first->second;
  }

  std::map<double, SquaresLaw> laws_;
  std::map<std::pair<double, double>, Interval> intervals_;
};

}  // namespace

MemberTest ratio_test(Family family, Member member, const SquaresLaw& law) {
  const double ratio = member.estimate;
  member.p = law.p_value(ratio);
  return {family, std::move(member),
          [law, ratio](double level) { return law.interval(ratio, level); }};
}

std::vector<FamilyTest> judge_tests(std::vector<MemberTest> tests, double level) {
  std::ranges::stable_sort(tests, {}, &MemberTest::family);
  std::vector<FamilyTest> families;
  for (const MemberTest& one : tests) {
    if (families.empty() || families.back().family != one.family) {
      families.push_back({.family = one.family, .members = {}});
    }
    families.back().members.push_back(one.member);
  }
  auto next = tests.begin();
  for (FamilyTest& family : families) {
    const auto count = static_cast<double>(families.size() * family.members.size());
    for (Member& member : family.members) {
      member.interval = next->interval(level);
      member.simultaneous = next->interval(1.0 - (1.0 - level) / count);
      ++next;
    }
  }
  judge_together(families, level);
  return families;
}

void SummedError::add(std::size_t scan, double nees, double dimension) {
  if (std::isnan(nees)) return;
  scans_[scan].nees += nees;
  scans_[scan].dimensions += dimension;
  scans_[scan].runs += 1.0;
}

std::vector<MemberTest> SummedError::scan_tests(std::span<const double> times) const {
  std::vector<MemberTest> all;
  const auto laws = std::make_shared<ScanLaws>();
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    const double freedom = scans_[s].dimensions;
    if (!(freedom > 0.0)) continue;
    const double ratio = scans_[s].ratio();
    Member member{.from = times[s], .to = times[s], .estimate = ratio};
    member.p = laws->p_value(freedom, ratio);
    all.push_back({Family::scan, std::move(member), [laws, freedom, ratio](double level) {
                     return laws->interval(freedom, ratio, level);
                   }});
  }
  return all;
}

double SummedError::most_runs() const {
  double most = 0.0;
  for (const Scan& scan : scans_) most = std::max(most, scan.runs);
  return most;
}

MemberTest SummedError::size_test() const {
  const Scan sum = sum_of(0, scans_.size());
  const double runs = most_runs();
  double deviation = 0.0;  // of a run's sum, over the square root of 2
  for (const Scan& scan : scans_) {
    if (scan.runs > 0.0) deviation += std::sqrt(scan.dimensions / scan.runs);
  }
  const SquaresLaw law(traces_of_constant_errors(sum.dimensions / runs, deviation * deviation),
                       runs);
  return ratio_test(Family::size, {.name = "NEES", .estimate = sum.ratio()}, law);
}

std::vector<FamilyTest> SummedError::families(double level, std::span<const double> times) const {
  if (!(most_runs() > 0.0)) return {};
  std::vector<MemberTest> all = scan_tests(times);
  all.push_back(size_test());
  return judge_tests(std::move(all), level);
}

SummedError::Scan SummedError::sum_of(std::size_t first, std::size_t end) const {
  Scan sum;
  for (std::size_t s = first; s < end; ++s) {
    sum.nees += scans_[s].nees;
    sum.dimensions += scans_[s].dimensions;
  }
  return sum;
}

std::vector<FamilyTest> SummedError::white_families(double level,
                                                    std::span<const double> times) const {
  std::vector<MemberTest> all = scan_tests(times);
  const auto add_sum = [&](Family family, Member member, std::size_t first, std::size_t end) {
    const Scan sum = sum_of(first, end);
    if (!(sum.dimensions > 0.0)) return;
    member.estimate = sum.ratio();
    const SquaresLaw law({1.0, 1.0, 1.0}, sum.dimensions);
    all.push_back(ratio_test(family, std::move(member), law));
  };
  add_sum(Family::size, {.name = "all"}, 0, scans_.size());
  const std::size_t stretches = scans_.size() < 2 * kStretches ? 0 : kStretches;
  for (std::size_t k = 0; k < stretches; ++k) {
    const std::size_t first = k * scans_.size() / stretches;
    const std::size_t end = (k + 1) * scans_.size() / stretches;
    add_sum(Family::stretch, {.from = times[first], .to = times[end - 1]}, first, end);
  }
  return judge_tests(std::move(all), level);
}

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
