// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/nees_accumulator.hpp"

#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/score.hpp"
#include "analysis/statistics/means.hpp"

#include <cmath>
#include <map>

namespace montecarta::analysis {
namespace {

/// A consistent filter's NEES is above ten times its mean once in a million samples.
constexpr double kCapFactor = 10.0;

/// Both bands of every scan, from the runs that are valid there: nearly always of one number.
class BandsOf {
 public:
  BandsOf(std::size_t dimension, double level, double whole_run_level)
      : dimension_(dimension), level_(level), whole_run_level_(whole_run_level) {}

  struct Bands {
    Interval pointwise, whole_run;
  };
  const Bands& of(std::uint32_t runs) {
    const auto [found, is_new] = known_.try_emplace(runs);
    if (is_new && runs > 0) {
      found->second = {nees_bounds(runs, dimension_, level_),
                       nees_bounds(runs, dimension_, whole_run_level_)};
    }
    return found->second;
  }

 private:
  std::size_t dimension_;
  double level_, whole_run_level_;
  std::map<std::uint32_t, Bands> known_;
};

}  // namespace

double nees_distance(double nees, std::size_t dimension) {
  return std::abs(std::log2(nees / static_cast<double>(dimension)));
}

NeesAccumulator::NeesAccumulator(ErrorBlock block, Moments moments, std::size_t scans,
                                 std::size_t dimension)
    : block_(block),
      moments_(moments),
      dimension_(dimension == 0 ? dimension_of(block) : dimension),
      sum_(scans),
      runs_(scans),
      table_(scans),
      neighbours_(scans) {}

void NeesAccumulator::add(const RunMetrics& metrics) {
  const auto block = static_cast<std::size_t>(block_);
  const NeesRows& rows = metrics.nees(moments_);
  add(rows.value[block], rows.rank[block], rows.too_few[block]);
}

void NeesAccumulator::add(std::span<const double> value, std::span<const int> rank,
                          std::span<const std::uint8_t> too_few) {
  samples_ += value.size();
  for (std::size_t s = 0; s < value.size(); ++s) {
    const bool has_lower_rank =
        !rank.empty() && rank[s] >= 0 && static_cast<std::size_t>(rank[s]) < dimension_;
    if (has_lower_rank) ++lower_rank_;
    if (!std::isfinite(value[s])) {
      if (!too_few.empty() && too_few[s] != 0) {
        ++too_few_;
      } else if (!has_lower_rank) {
        ++unusable_;
      }
      continue;
    }
    sum_[s] += value[s];
    ++runs_[s];
    table_.add(s, value[s]);
  }
  neighbours_.add(value, kCapFactor * static_cast<double>(dimension_));
  const double average = mean_of_finite(value);
  if (std::isnan(average)) {
    ++unjudged_runs_;
  } else {
    run_averages_.push_back(average);
  }
}

NeesSeries NeesAccumulator::series(double level, double verdict_level,
                                   const BandWalks& walks) const {
  NeesSeries series;
  series.dimension = dimension_;
  series.samples = samples_;
  series.lower_rank = lower_rank_;
  series.unusable = unusable_;
  series.too_few = too_few_;
  series.runs = runs_;
  series.run_averages = run_averages_;
  series.unjudged_runs = unjudged_runs_;
  series.test =
      walks.test(neighbours_.result(), run_averages_.size(), series.dimension, verdict_level);
  BandsOf bands(series.dimension, level, std::erf(series.test.deviate / std::sqrt(2.0)));
  for (std::size_t s = 0; s < sum_.size(); ++s) {
    series.bounds.push_back(bands.of(runs_[s]).pointwise);
    series.whole_run_bounds.push_back(bands.of(runs_[s]).whole_run);
    series.average.push_back(sum_[s] / runs_[s]);  // NaN where no run is valid
    series.median.push_back(table_.median(s));
    series.trimmed.push_back(table_.trimmed_mean(s, kTrimmedShare));
  }
  return series;
}

NeesResult NeesAccumulator::result(std::span<const double> times, double level,
                                   const BandWalks& walks, double within,
                                   std::optional<double> look_level) const {
  NeesResult result{block_, moments_, series(level, look_level.value_or(level), walks), {}};
  result.consistency = judge(result.series, times, within);
  return result;
}

}  // namespace montecarta::analysis
