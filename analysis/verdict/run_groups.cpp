// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/run_groups.hpp"

#include "analysis/statistics/run_mean.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace montecarta::analysis {
namespace {

/// The test of a variance or a fourth moment that is 0 for a consistent filter; only too large a
/// one is off. `written` converts it to the number that readers see.
template <class Written>
MemberTest excess_test(Family family, const char* name, const Summary& excess, double unit,
                       Written written) {
  const RunMean mean = RunMean::of_symmetric(excess);
  const auto in_units = [unit, written](double value) { return written(value / unit); };
  Member member{.name = name, .estimate = in_units(excess.mean)};
  member.p = mean.p_value_above_zero();
  return {family, std::move(member), [mean, in_units](double level) {
            const Interval found = mean.interval(level);
            return Interval{in_units(found.lower), in_units(found.upper)};
          }};
}

}  // namespace

RunGroups::RunGroups(std::size_t dimension, std::vector<std::size_t> ends)
    : dimension_(dimension), ends_(std::move(ends)) {}

void RunGroups::add(std::span<const double> whitened) {
  group_.emplace_back(whitened.begin(), whitened.end());
  if (group_.size() == kRuns) end_group();
}

void RunGroups::end_group() {
  blank_incomplete();
  if (ends_.size() > 1) add_spread();
  add_tails();
  group_.clear();
}

/// Keeps only the errors that all runs of the group have: else sums would differ by their lengths.
void RunGroups::blank_incomplete() {
  for (std::size_t place = 0; place < group_[0].size(); ++place) {
    const bool is_whole = std::ranges::none_of(
        group_, [&](const std::vector<double>& run) { return std::isnan(run[place]); });
    if (is_whole) continue;
    for (std::vector<double>& run : group_) run[place] = 0.0;
  }
}

std::vector<double> RunGroups::products(std::size_t i, std::size_t j) const {
  std::vector<double> parts(ends_.size() * dimension_);
  const std::vector<double>&a = group_[i], &b = group_[j];
  std::size_t place = 0;
  for (std::size_t stretch = 0; stretch < ends_.size(); ++stretch) {
    double* const part = parts.data() + stretch * dimension_;
    while (place < ends_[stretch] * dimension_) {
      for (std::size_t k = 0; k < dimension_; ++k, ++place) part[k] += a[place] * b[place];
    }
  }
  return parts;
}

// Errors with heavy tails have large squares together at neighbouring scans, whereas the scale of a
// run is common to the whole run. So only parts are multiplied that are three eighths of the drive
// apart, and of different components if there are several.
double RunGroups::of_different_parts(std::span<const double> x, std::span<const double> y) const {
  const std::size_t stretches = ends_.size();
  double sum = 0.0;
  for (std::size_t s = 0; s < stretches; ++s) {
    for (std::size_t t = 0; t < stretches; ++t) {
      const std::size_t apart = s < t ? t - s : s - t;
      if (8 * apart < 3 * stretches) continue;
      double all_x = 0.0, all_y = 0.0, own = 0.0;
      for (std::size_t k = 0; k < dimension_; ++k) {
        const double of_x = x[s * dimension_ + k], of_y = y[t * dimension_ + k];
        all_x += of_x;
        all_y += of_y;
        own += of_x * of_y;
      }
      sum += dimension_ == 1 ? own : all_x * all_y - own;
    }
  }
  return sum;
}

// Half the squared difference of two runs' sums of squares has their variance as its mean; for
// Gaussian errors the mean is also twice the squared product of the errors.
void RunGroups::add_spread() {
  std::vector<std::vector<double>> squares;
  for (std::size_t i = 0; i < kRuns; ++i) squares.push_back(products(i, i));
  double excess = 0.0, unit = 0.0;
  for (std::size_t i = 0; i < kRuns; ++i) {
    for (std::size_t j = i + 1; j < kRuns; ++j) {
      std::vector<double> difference = squares[i];
      for (std::size_t a = 0; a < difference.size(); ++a) difference[a] -= squares[j][a];
      const std::vector<double> common = products(i, j);
      excess += 0.5 * of_different_parts(difference, difference) -
                2.0 * of_different_parts(common, common);
      unit += of_different_parts(squares[i], squares[j]);
    }
  }
  constexpr double kPairs = 0.5 * kRuns * (kRuns - 1);
  spread_.add(excess / kPairs);
  spread_unit_.add(unit / kPairs);
}

// The fourth moment of a Gaussian error is three times its squared variance. The product of the
// squares of two runs estimates that square, so that scales may differ from scan to scan.
void RunGroups::add_tails() {
  double fourth = 0.0, squared = 0.0, places = 0.0;
  for (std::size_t place = 0; place < group_[0].size(); ++place) {
    double squares = 0.0, fourths = 0.0;
    for (const std::vector<double>& run : group_) {
      const double square = run[place] * run[place];
      squares += square;
      fourths += square * square;
    }
    if (squares == 0.0) continue;
    fourth += fourths / kRuns;
    squared += (squares * squares - fourths) / (kRuns * (kRuns - 1.0));
    places += 1.0;
  }
  if (places == 0.0) return;
  tails_.add((fourth - 3.0 * squared) / places);
  tails_unit_.add(squared / places);
}

void RunGroups::add_tests(std::vector<MemberTest>& all) const {
  const Summary spread = spread_.result(), tails = tails_.result();
  const double spread_unit = spread_unit_.result().mean, tails_unit = tails_unit_.result().mean;
  if (spread.n >= kFewestGroups && spread_unit > 0.0) {
    all.push_back(excess_test(Family::between_runs, "runs", spread, spread_unit,
                              [](double variance) { return std::sqrt(std::max(0.0, variance)); }));
  }
  if (tails.n >= kFewestGroups && tails_unit > 0.0) {
    all.push_back(excess_test(Family::tails, "fourth moment", tails, tails_unit,
                              [](double excess) { return excess; }));
  }
}

}  // namespace montecarta::analysis
