// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/whole_error.hpp"

#include "analysis/run/whitened_run.hpp"
#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/run_mean.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kFewestKeptRuns = 50, kMostKeptRuns = 256;

constexpr std::size_t kMostKeptErrors = 8'000'000;  // largest number of errors that are kept, 64 MB

/// The fewest errors in which a repeat is detected. Shorter sequences may be equal by chance, since
/// files have few digits.
constexpr std::size_t kFewestErrorsOfARepeat = 8;

/// Means of several numbers of one run, in each stretch and over the whole drive.
class Means {
 public:
  explicit Means(std::size_t numbers) : whole_(numbers), stretch_(numbers) {}
  void add(std::size_t number, double value) { stretch_[number].add(value); }
  template <class OverDrive>
  void end_stretch(std::size_t stretch, std::vector<OverDrive>& over_runs) {
    for (std::size_t k = 0; k < stretch_.size(); ++k) {
      if (!over_runs[k].stretch.empty()) stretch_[k].end_run(over_runs[k].stretch[stretch]);
      whole_[k].add(std::exchange(stretch_[k], {}));
    }
  }
  /// Mean over the whole drive.
  double mean(std::size_t number) const { return whole_[number].mean(); }
  template <class OverDrive>
  void end_run(std::vector<OverDrive>& over_runs) {
    for (std::size_t k = 0; k < whole_.size(); ++k) whole_[k].end_run(over_runs[k].whole);
  }

 private:
  std::vector<MeanOfRun> whole_, stretch_;
};

/// {scan} Sums; NaN where there is nothing to sum.
std::vector<double> sums_of(std::span<const MeanOfRun> ratios) {
  std::vector<double> sums;
  for (const MeanOfRun& ratio : ratios) sums.push_back(ratio.n > 0.0 ? ratio.sum : kNaN);
  return sums;
}

std::vector<double> numbers_of(std::span<const MeanOfRun> ratios) {
  std::vector<double> numbers;
  for (const MeanOfRun& ratio : ratios) numbers.push_back(ratio.n);
  return numbers;
}

/// The family that judges the same quantity in single stretches.
Family by_stretch(Family family) {
  return family == Family::component ? Family::component_by_stretch
         : family == Family::bias    ? Family::bias_by_stretch
                                     : Family::correlation_by_stretch;
}

MemberTest zero_test(Family family, Member member, const RunMean& mean) {
  member.estimate = mean.mean();
  member.p = mean.p_value(0.0);
  return {family, std::move(member), [mean](double level) { return mean.interval(level); }};
}

/// Judges tests together, of errors that passed `gate` if there is one.
std::vector<FamilyTest> judged(std::vector<MemberTest> all, double level, const GateScale* gate) {
  if (gate == nullptr) return judge_tests(std::move(all), level);
  std::erase_if(all, [](const MemberTest& test) {
    return test.family == Family::component || test.family == Family::component_by_stretch;
  });
  std::vector<FamilyTest> families = judge_tests(std::move(all), level);
  gate->put_factors(families);
  return families;
}

}  // namespace

WholeError::WholeError(std::size_t dimension, std::size_t scans)
    : dimension_(dimension),
      ends_(ends_of_stretches(scans)),
      nees_(scans),
      stretch_(ends_.size()),
      against_run_(ends_.size()),
      groups_(dimension, ends_),
      bets_{std::vector<Bets>(1), std::vector<Bets>(dimension > 1 ? dimension : 0),
            std::vector<Bets>(ends_.size() > 1 ? ends_.size() : 0)},
      exact_(dimension) {
  OverDrive number;
  if (stretches() > 1) number.stretch.resize(stretches());
  component_.assign(dimension, number);
  bias_ = component_;
  if (!has_pairs()) return;
  correlation_.assign(dimension * (dimension - 1) / 2, number);
  whitened_mean_.assign(dimension, number);
}

void WholeError::add(const WhitenedRun& run, std::span<const double> nees) {
  expect(run.dimension == dimension_ && run.whitened.size() == ends_.back() * dimension_ &&
             run.standardised.size() == run.whitened.size(),
         "errors are {scan, component}");
  const std::vector<MeanOfRun> ratios = ratios_of(run, nees);
  nees_.add(sums_of(ratios), numbers_of(ratios));
  for (std::size_t k = 0; k < run.errors_of_exact.size(); ++k) {
    exact_[k].merge({run.errors_of_exact[k]});
  }
  if (std::ranges::all_of(nees, [](double value) { return std::isnan(value); })) return;
  add_stretches(ratios);
  add_components(run);
  add_fingerprint(run);
  if (std::ranges::all_of(run.whitened, [](double u) { return std::isnan(u); })) return;
  along_.add(run);
  add_correlations(run);
  groups_.add(run.whitened);
  if (!has_pairs() && whitened_.size() < most_kept_runs()) whitened_.push_back(run.whitened);
}

/// {scan} Sum and number of the squares of a run: of L^-1 e if it is known, so that components that
/// are known exactly are not counted, else the NEES in the range of the covariance.
std::vector<MeanOfRun> WholeError::ratios_of(const WhitenedRun& run,
                                             std::span<const double> nees) const {
  std::vector<MeanOfRun> ratios(nees.size());
  for (std::size_t s = 0; s < nees.size(); ++s) {
    if (std::isnan(nees[s])) continue;
    for (std::size_t k = s * dimension_; k < (s + 1) * dimension_; ++k) {
      ratios[s].add(run.whitened[k] * run.whitened[k]);
    }
    if (ratios[s].n == 0.0) ratios[s] = {.sum = nees[s], .n = static_cast<double>(dimension_)};
  }
  return ratios;
}

std::size_t WholeError::most_kept_runs() const {
  const std::size_t length = std::max<std::size_t>(ends_.back() * dimension_, 1);
  return std::clamp(kMostKeptErrors / length, kFewestKeptRuns, kMostKeptRuns);
}

void WholeError::add_stretches(std::span<const MeanOfRun> ratios) {
  std::vector<MeanOfRun> of_stretch(stretches());
  MeanOfRun whole;
  for (std::size_t k = 0; k < stretches(); ++k) {
    for (std::size_t s = first_scan(k); s < ends_[k]; ++s) of_stretch[k].add(ratios[s]);
    whole.add(of_stretch[k]);
  }
  bets_[0][0].add(whole.mean());
  for (std::size_t k = 0; k < stretches(); ++k) {
    const double ratio = of_stretch[k].mean();
    of_stretch[k].end_run(stretch_[k]);
    if (stretches() > 1) bets_[2][k].add(ratio);
    if (!std::isnan(ratio)) against_run_[k].add(ratio - whole.mean());
  }
}

void WholeError::add_components(const WhitenedRun& run) {
  Means squares(dimension_), means(dimension_);
  std::size_t place = 0;
  for (std::size_t stretch = 0; stretch < stretches(); ++stretch) {
    while (place < ends_[stretch] * dimension_) {
      for (std::size_t k = 0; k < dimension_; ++k, ++place) {
        const double z = run.standardised[place];
        largest_.add(z, {.run = run.number, .scan = place / dimension_, .component = k});
        squares.add(k, z * z);
        means.add(k, z);
      }
    }
    squares.end_stretch(stretch, component_);
    means.end_stretch(stretch, bias_);
  }
  for (std::size_t k = 0; k < bets_[1].size(); ++k) bets_[1][k].add(squares.mean(k));
  squares.end_run(component_);
  means.end_run(bias_);
}

void WholeError::add_correlations(const WhitenedRun& run) {
  Means products(correlation_.size()), means(whitened_mean_.size());
  for (std::size_t stretch = 0; stretch < stretches(); ++stretch) {
    for (std::size_t s = first_scan(stretch); s < ends_[stretch]; ++s) {
      const double* const u = run.whitened.data() + s * dimension_;
      std::size_t pair = 0;
      for (std::size_t a = 0; has_pairs() && a < dimension_; ++a) {
        means.add(a, u[a]);
        for (std::size_t b = a + 1; b < dimension_; ++b) products.add(pair++, u[a] * u[b]);
      }
    }
    products.end_stretch(stretch, correlation_);
    means.end_stretch(stretch, whitened_mean_);
  }
  products.end_run(correlation_);
  means.end_run(whitened_mean_);
}

void WholeError::Largest::add(double error, const ErrorPlace& where) {
  if (std::isnan(error)) return;
  ++samples;
  if (!(std::abs(error) > deviations)) return;
  deviations = std::abs(error);
  place = where;
}

void WholeError::Largest::merge(const Largest& next) {
  const std::uint64_t all = samples + next.samples;
  if (next.deviations > deviations) *this = next;
  samples = all;
}

/// Adds a fingerprint of the errors: equal for runs whose errors are equal bit by bit, and hardly
/// ever for others.
void WholeError::add_fingerprint(const WhitenedRun& run) {
  std::uint64_t hash = 0;
  std::size_t n = 0;
  for (const double error : run.standardised) {
    if (error == 0.0 || std::isnan(error) || std::abs(error) == kLargestError) continue;
    ++n;
    hash = (hash ^ std::bit_cast<std::uint64_t>(error)) * 0x9e3779b97f4a7c15ULL;
    hash ^= hash >> 29;
  }
  if (n < kFewestErrorsOfARepeat) return;
  fingerprints_.push_back(hash);
  numbers_.push_back(run.number);
}

Member WholeError::in_stretch(std::string name, std::size_t stretch,
                              const ErrorNames& names) const {
  Member member{.name = std::move(name)};
  member.from = names.times[first_scan(stretch)];
  member.to = names.times[ends_[stretch] - 1];
  member.origin = origin_of(names.times);
  return member;
}

void WholeError::add_stretch_tests(const ErrorNames& names, std::vector<MemberTest>& all) const {
  for (std::size_t k = 0; stretches() > 1 && k < stretches(); ++k) {
    const Summary ratio = stretch_[k].result();
    if (ratio.n < kFewestJudgedRuns) continue;
    all.push_back(ratio_test(Family::stretch, in_stretch("", k, names), RunMean::of_ratio(ratio)));
  }
}

template <class Test>
void WholeError::add_tests(const OverDrive& number, const std::string& name,
                           const ErrorNames& names, Test test, std::vector<MemberTest>& all) const {
  const Summary whole = number.whole.result();
  if (whole.n < kFewestJudgedRuns) return;
  all.push_back(test(Member{.name = name}, whole, stretches()));
  for (std::size_t k = 0; k < number.stretch.size(); ++k) {
    const Summary part = number.stretch[k].result();
    if (part.n < kFewestJudgedRuns) continue;
    all.push_back(test(in_stretch(name, k, names), part, k));
    all.back().family = by_stretch(all.back().family);
  }
}

/// The part of the mean product of two components that comes from their biases, in a stretch, or
/// over the whole drive if `stretch` is the number of stretches.
double WholeError::product_of_biases(std::size_t a, std::size_t b, std::size_t stretch) const {
  const auto bias = [&](std::size_t component, std::size_t k) {
    const OverDrive& means = whitened_mean_[component];
    return (means.stretch.empty() ? means.whole : means.stretch[k]).result().mean;
  };
  if (stretch < stretches()) return bias(a, stretch) * bias(b, stretch);
  double sum = 0.0, n = 0.0;
  for (std::size_t k = 0; k < stretches(); ++k) {
    const double product = bias(a, k) * bias(b, k);
    if (std::isnan(product)) continue;
    sum += product;
    n += 1.0;
  }
  return sum / n;
}

void WholeError::add_correlation_tests(const ErrorNames& names,
                                       std::vector<MemberTest>& all) const {
  const double ratio = nees_.ratios().mean;
  if (!(ratio > 0.0)) return;
  std::size_t pair = 0;
  for (std::size_t a = 0; has_pairs() && a < dimension_; ++a) {
    for (std::size_t b = a + 1; b < dimension_; ++b) {
      const auto test = [&](Member member, const Summary& runs, std::size_t stretch) {
        const double of_biases = product_of_biases(a, b, stretch);
        return zero_test(Family::correlation, std::move(member),
                         RunMean::of_product(runs).in_units_of(ratio, of_biases));
      };
      add_tests(correlation_[pair++], names.components[a] + " and " + names.components[b], names,
                test, all);
    }
  }
  for (MemberTest& one : direction_tests(whitened_, ratio, names.components)) {
    all.push_back(std::move(one));
  }
}

/// Tests the largest error of all by the normal law and the number of errors, whatever their
/// dependence is: the probability that it exceeds this number of deviations is at most the p-value.
/// It is compared with the size of the errors of its component in its stretch, so that optimism
/// there is not taken for a heavy tail.
void WholeError::add_largest_test(const ErrorNames& names, std::vector<MemberTest>& all) const {
  if (largest_.samples == 0) return;
  expect(largest_.place.component < std::min(component_.size(), names.components.size()) &&
             largest_.place.scan < std::min(ends_.back(), names.times.size()),
         "a largest error of a component and a scan");
  const OverDrive& squares = component_[largest_.place.component];
  std::size_t stretch = 0;
  while (ends_[stretch] <= largest_.place.scan) ++stretch;
  const SummaryOf& near = squares.stretch.empty() ? squares.whole : squares.stretch[stretch];
  const double ratio = std::max(1.0, near.result().mean);
  const double tail = normal_cdf(-largest_.deviations / std::sqrt(ratio));
  Member member{.name = names.components[largest_.place.component] + " in run " +
                        std::to_string(largest_.place.run),
                .estimate = largest_.deviations};
  member.from = member.to = names.times[largest_.place.scan];
  member.origin = origin_of(names.times);
  member.p = std::min(1.0, 2.0 * tail * static_cast<double>(largest_.samples));
  all.push_back({Family::tails, std::move(member), [](double) { return Interval{kNaN, kNaN}; }});
}

std::vector<FamilyTest> WholeError::families(double level, const ErrorNames& names,
                                             const GateScale* gate) const {
  if (nees_.ratios().n < kFewestJudgedRuns) {
    std::vector<MemberTest> all = nees_.scan_tests(names.times);
    std::ranges::move(along_.tests(names.components), std::back_inserter(all));
    return judged(std::move(all), level, gate);
  }
  return judged(tests_over_runs(names), level, gate);
}

/// The tests of three runs and more.
std::vector<MemberTest> WholeError::tests_over_runs(const ErrorNames& names) const {
  std::vector<MemberTest> all = nees_.scan_tests(names.times);
  expect(dimension_ <= std::min(names.components.size(), bias_.size()) &&
             (dimension_ == 1 || dimension_ <= component_.size()),
         "sums of each component");
  all.push_back(nees_.size_test());
  add_stretch_tests(names, all);
  const auto squares = [](Member member, const Summary& runs, std::size_t) {
    return ratio_test(Family::component, std::move(member), RunMean::of_ratio(runs));
  };
  const auto mean = [](Member member, const Summary& runs, std::size_t) {
    return zero_test(Family::bias, std::move(member), RunMean::of_product(runs));
  };
  for (std::size_t k = 0; k < dimension_; ++k) {
    if (dimension_ > 1) add_tests(component_[k], names.components[k], names, squares, all);
    add_tests(bias_[k], names.components[k], names, mean, all);
  }
  judge_along_drives(names, all);
  add_correlation_tests(names, all);
  groups_.add_tests(all);
  add_largest_test(names, all);
  return all;
}

std::vector<FamilyTest> WholeError::white_families(double level, const ErrorNames& names,
                                                   const GateScale* gate) const {
  if (!has_drives()) return {};
  std::vector<MemberTest> all =
      nees_.ratios().n < kFewestJudgedRuns ? nees_.scan_tests(names.times) : tests_over_runs(names);
  std::erase_if(all, [](const MemberTest& test) {
    return test.family == Family::size || test.family == Family::component ||
           test.family == Family::stretch;
  });
  std::vector<Member> members;
  for (std::size_t k = 0; stretches() > 1 && k < stretches(); ++k) {
    members.push_back(in_stretch("", k, names));
  }
  std::ranges::move(along_.white_tests(names.components, ends_, members), std::back_inserter(all));
  return judged(std::move(all), level, gate);
}

/// Puts the tests along the drives in place of those of size and components, if the errors of all
/// runs were kept and forget fast.
void WholeError::judge_along_drives(const ErrorNames& names, std::vector<MemberTest>& all) const {
  if (!has_drives() || !along_.have_short_memory()) return;
  std::vector<MemberTest> tests = along_.tests(names.components);
  if (tests.empty()) return;
  std::erase_if(all, [](const MemberTest& test) {
    return test.family == Family::size || test.family == Family::component;
  });
  std::ranges::move(tests, std::back_inserter(all));
}

std::optional<Side> WholeError::refused_by_bets(double margin, double level) const {
  return refused_side(bets_, margin, level);
}

BesideTests WholeError::beside_tests(const ErrorNames& names) const {
  BesideTests found;
  for (std::size_t k = 0; k < exact_.size(); ++k) {
    if (exact_[k].value > 0.0) found.exact.push_back({names.components[k], exact_[k].value});
  }
  std::map<std::uint64_t, std::uint64_t> first_of;
  for (std::size_t k = 0; k < fingerprints_.size(); ++k) {
    const auto [first, is_new] = first_of.try_emplace(fingerprints_[k], numbers_[k]);
    if (is_new) continue;
    if (found.repeated_runs++ == 0) found.first_repeat = {numbers_[k], first->second};
  }
  double least = 1.0;
  for (const SummaryOf& difference : against_run_) {
    least = std::min(least, RunMean::of_product(difference.result()).p_value(0.0));
  }
  found.p_of_equal_stretches =
      stretches() > 1 ? std::min(1.0, least * static_cast<double>(stretches())) : 1.0;
  return found;
}

}  // namespace montecarta::analysis
