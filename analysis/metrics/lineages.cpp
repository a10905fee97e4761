// SPDX-License-Identifier: BSD-3-Clause
// Ancestors of the particles, and the Monte Carlo error of few particles.
#include "analysis/metrics/lineages.hpp"

#include "analysis/metrics/cell_analysis.hpp"
#include "analysis/metrics/diversity.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kMostScansOfLineages = 32;
constexpr double kSameTime = 1e-9;

template <double Lineages::*kValue>
double of_lineages(const MeasuredRun& run) {
  const Lineages* lineages = run.metrics.lineages();
  return lineages == nullptr ? kNaN : lineages->*kValue;
}

constexpr Score kLineagesScores[] = {
    {"coalescence", "s", "time back to the common ancestor", of_lineages<&Lineages::coalescence>,
     Better::higher},
    {"monte_carlo_variance", "m2", "position variance by few particles",
     of_lineages<&Lineages::monte_carlo_variance>},
};

class LineagesOverRuns final : public MergedSums<LineagesOverRuns> {
 public:
  explicit LineagesOverRuns(const RunCriteria& /*criteria*/) {}
  void add(const MeasuredRun& run) override {
    if (run.metrics.lineages() != nullptr) lineages_.add(*run.metrics.lineages());
  }
  void put(CellAnalysis& cell) override {
    if (!lineages_.empty()) cell.findings.put(lineages_.result());
  }
  static constexpr auto parts() { return std::tuple(added(&LineagesOverRuns::lineages_)); }

 private:
  LineageSums lineages_;
};

void lineages_numbers(const CellAnalysis& cell, std::vector<NamedNumber>& all) {
  const bool known = cell.find<LineageSummary>() != nullptr;
  const LineageSummary& lineages = cell.get<LineageSummary>();
  for (std::size_t lag = 0; lag < kLineageLags.size(); ++lag) {
    all.push_back({"distinct_ancestors_" + readable(kLineageLags[lag], 1) + "_s_ago", "1",
                   known ? lineages.ancestors[lag] : kNaN});
  }
  all.push_back({"coalescence", "s", known ? lineages.coalescence : kNaN});
  all.push_back({"coalesced_share", "1", known ? lineages.coalesced_share : kNaN});
  all.push_back({"monte_carlo_share", "1", known ? lineages.monte_carlo_share : kNaN});
}

}  // namespace

namespace {

/// Whether everyone is their own parent. Throws RunError where a parent does not exist.
bool is_identity(std::span<const std::uint32_t> parents) {
  std::uint32_t differences = 0, largest = 0;
  for (std::uint32_t i = 0; i < parents.size(); ++i) {
    differences |= parents[i] ^ i;
    largest = std::max(largest, parents[i]);
  }
  if (largest >= parents.size()) {
    throw RunError("ancestor: parent " + std::to_string(largest) + " of " +
                   std::to_string(parents.size()) +
                   " particles (the column is damaged): run the study again");
  }
  return differences == 0;
}

}  // namespace

void find_resamplings(std::span<const std::uint32_t> ancestor, std::size_t particles,
                      std::vector<std::size_t>& resampled) {
  resampled.resize(particles == 0 ? 0 : ancestor.size() / particles);
  std::size_t latest = 0;
  for (std::size_t s = 0; s < resampled.size(); ++s) {
    if (!is_identity(ancestor.subspan(s * particles, particles))) latest = s + 1;
    resampled[s] = latest;
  }
}

struct LineageWalker::Sums {
  std::array<SummaryOf, kLineageLags.size()> ancestors;
  SummaryOf coalescence, coalesced, variance, squared_error;
};

/// With `ancestor_` telling the families of the particles of scan `s`.
double LineageWalker::family_variance(const RunRows& rows, std::size_t s) {
  const std::size_t particles = ancestor_.size();
  const double* const pose = rows.particle_pose.data() + 3 * particles * s;
  const double* const log_weight = rows.log_weight.data() + particles * s;
  double x = 0.0, y = 0.0;
  for (std::size_t i = 0; i < particles; ++i) {
    x += std::exp(log_weight[i]) * pose[3 * i];
    y += std::exp(log_weight[i]) * pose[3 * i + 1];
  }
  families_.assign(2 * particles, 0.0);
  for (std::size_t i = 0; i < particles; ++i) {
    const double weight = std::exp(log_weight[i]);
    families_[2 * ancestor_[i]] += weight * (pose[3 * i] - x);
    families_[2 * ancestor_[i] + 1] += weight * (pose[3 * i + 1] - y);
  }
  return std::inner_product(families_.begin(), families_.end(), families_.begin(), 0.0);
}

/// Walks from resampling to resampling; between them everyone is their own parent.
void LineageWalker::walk_from(std::size_t s, const RunRows& rows, std::span<const double> times,
                              Sums& sums) {
  const std::size_t particles = ancestor_.size();
  bool is_before_family_lag = !rows.particle_pose.empty();
  set_.start(particles);
  std::iota(ancestor_.begin(), ancestor_.end(), 0u);
  std::size_t lag = 0;
  const auto count_until = [&](double back) {
    for (; lag < kLineageLags.size() && back >= kLineageLags[lag]; ++lag) {
      sums.ancestors[lag].add(static_cast<double>(set_.size()));
    }
    if (!is_before_family_lag || back < kDiversityLag) return;
    is_before_family_lag = false;
    if (set_.size() > 1) sums.variance.add(family_variance(rows, s));
  };
  for (std::size_t next = resampled_[s]; next > 0 && set_.size() > 1;) {
    const std::size_t scan = next - 1;
    count_until(times[s] - times[scan] + kSameTime);
    const std::span parents(rows.ancestor.data() + particles * scan, particles);
    set_.step_back(parents);
    if (is_before_family_lag) {
      for (std::uint32_t& ancestor : ancestor_) ancestor = parents[ancestor];
    }
    next = scan > 0 ? resampled_[scan - 1] : 0;
    if (set_.size() > 1) continue;
    sums.coalescence.add(times[s] - (scan == 0 ? 0.0 : times[scan - 1]) + kSameTime);
  }
  sums.coalesced.add(set_.size() == 1 ? 1.0 : 0.0);
  // If one ancestor is left, it is left at every longer lag of the run too.
  count_until(times[s] + kSameTime);
}

Lineages LineageWalker::walk(const RunRows& rows, std::size_t particles,
                             std::span<const double> times,
                             std::span<const double> squared_position) {
  ancestor_.resize(particles);
  find_resamplings(rows.ancestor, particles, resampled_);
  Sums sums;
  const std::size_t every = (times.size() + kMostScansOfLineages - 1) / kMostScansOfLineages;
  for (std::size_t s = every - 1; s < times.size(); s += every) {
    walk_from(s, rows, times, sums);
    if (!squared_position.empty()) sums.squared_error.add(squared_position[s]);
  }
  Lineages lineages;
  for (std::size_t lag = 0; lag < kLineageLags.size(); ++lag) {
    lineages.ancestors[lag] = sums.ancestors[lag].result().mean;
  }
  lineages.coalescence = sums.coalescence.result().mean;
  lineages.coalesced_share = sums.coalesced.result().mean;
  lineages.monte_carlo_variance = sums.variance.result().mean;
  lineages.squared_error = sums.squared_error.result().mean;
  return lineages;
}

void LineageSums::Mean::add(double value) {
  if (std::isnan(value)) return;
  sum += value;
  n += 1.0;
}

void LineageSums::add(const Lineages& lineages) {
  ++runs_;
  for (std::size_t lag = 0; lag < ancestors_.size(); ++lag) {
    ancestors_[lag].add(lineages.ancestors[lag]);
  }
  coalescence_.add(lineages.coalescence);
  coalesced_.add(lineages.coalesced_share);
  variance_.add(lineages.monte_carlo_variance);
  squared_error_.add(lineages.squared_error);
}

LineageSummary LineageSums::result() const {
  LineageSummary summary;
  for (std::size_t lag = 0; lag < ancestors_.size(); ++lag) {
    summary.ancestors[lag] = ancestors_[lag].value();
  }
  summary.coalescence = coalescence_.value();
  summary.coalesced_share = coalesced_.value();
  summary.monte_carlo_share = variance_.value() / squared_error_.value();
  return summary;
}

Metric lineages_metric() {
  return {.scores = kLineagesScores,
          .scores_are_numbers = false,
          .sums = make_sums<LineagesOverRuns>,
          .add_numbers = lineages_numbers};
}

}  // namespace montecarta::analysis
