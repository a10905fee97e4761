// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/printed/run_samples.hpp"

#include "analysis/metrics/nees_batches.hpp"
#include "analysis/metrics/paired_runs.hpp"
#include "analysis/statistics/means.hpp"
#include "analysis/statistics/spread.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

/// A number that only all runs of a cell together have: of an average NEES.
struct JointName {
  const char* name;
  const char* words;
  ErrorBlock block;
  double (*value)(const Consistency&);
  std::vector<double> BatchNumbers::*of_batches;
};

double inside(const Consistency& found) { return found.share_inside; }
double above(const Consistency& found) { return found.share_above; }
double exit_time(const Consistency& found) {
  return found.stays_above_from.value_or(std::numeric_limits<double>::infinity());
}

constexpr JointName kJoint[] = {
    {"share_inside_pose", "share of scans inside the band, pose", ErrorBlock::pose, inside,
     &BatchNumbers::share_inside},
    {"share_inside_position", "share of scans inside the band, position", ErrorBlock::position,
     inside, &BatchNumbers::share_inside},
    {"share_above_pose", "share of scans above the band, pose", ErrorBlock::pose, above,
     &BatchNumbers::share_above},
    {"share_above_position", "share of scans above the band, position", ErrorBlock::position, above,
     &BatchNumbers::share_above},
    {"stays_above_from_pose", "above the band to the end from, pose [s]", ErrorBlock::pose,
     exit_time, &BatchNumbers::stays_above_from},
    {"stays_above_from_position", "above the band to the end from, position [s]",
     ErrorBlock::position, exit_time, &BatchNumbers::stays_above_from},
};

template <class Names>
auto find_name(const Names& names, const std::string& name) {
  return std::ranges::find_if(names, [&](const auto& each) { return each.name == name; });
}

Sample joint_sample(const CellAnalysis& cell, const JointName& joint) {
  const NeesResult* nees = cell.find_nees(joint.block, cell.leading);
  if (nees == nullptr || nees->consistency.verdict == Verdict::untested) return {};
  return {joint.value(nees->consistency), kNaN, 1, {}};
}

std::vector<double> joint_batches(const CellAnalysis& cell, const JointName& joint,
                                  std::uint64_t runs, BatchBand band) {
  const NeesBatches& batches = cell.get<NeesBatches>();
  const BlockBatches* const found = batches.find(joint.block);
  if (found == nullptr || batches.runs != runs) return {};
  return (band == BatchBand::printed ? found->by_printed : found->by_expected).*joint.of_batches;
}

Sample sample_over(std::span<const double> values) {
  SummaryOf sums;
  for (const double value : values) sums.add(value);
  const Summary summary = sums.result();
  return {summary.mean, summary.sd, summary.n, {}};
}

/// (left, right) of every run that both cells completed.
std::vector<std::pair<double, double>> pairs_of(const CellAnalysis& left, const CellAnalysis& right,
                                                const Score& score) {
  const std::vector<double>&of_left = left.scores.column(score.name),
        &of_right = right.scores.column(score.name);
  std::vector<std::pair<double, double>> pairs;
  for (const auto& [l, r] : common_places(left.runs, right.runs)) {
    pairs.emplace_back(of_left[l], of_right[r]);
  }
  return pairs;
}

}  // namespace

Sample sample_of(const CellAnalysis* cell, const std::string& metric) {
  if (cell == nullptr) return {};
  if (const auto joint = find_name(kJoint, metric); joint != std::end(kJoint)) {
    return joint_sample(*cell, *joint);
  }
  const Score* score = find_score(metric);
  if (score == nullptr) return {};
  Sample sample = sample_over(cell->scores.column(score->name));
  sample.values = cell->scores.column(score->name);
  return sample;
}

Sample ratio_of(const CellAnalysis* cell, const CellAnalysis* unit, const std::string& metric) {
  const Score* score = find_score(metric);
  if (cell == nullptr || unit == nullptr || score == nullptr) return {};
  const double base = sample_of(unit, metric).mean;
  const double ratio = sample_of(cell, metric).mean / base;
  std::vector<double> deviations;  // of a linearised ratio
  for (const auto& [value, reference] : pairs_of(*cell, *unit, *score)) {
    deviations.push_back((value - ratio * reference) / base);
  }
  const Sample scatter = sample_over(deviations);
  return {ratio, scatter.sd, scatter.n, {}};
}

Sample difference_of(const CellAnalysis* left, const CellAnalysis* right,
                     const std::string& metric) {
  if (left == nullptr || right == nullptr) return {};
  const Score* score = find_score(metric);
  if (score == nullptr) {
    const double l = sample_of(left, metric).mean, r = sample_of(right, metric).mean;
    return {l == r ? 0.0 : l - r, kNaN, 1, {}};  // both may be infinite: never
  }
  std::vector<double> differences;
  for (const auto& [l, r] : pairs_of(*left, *right, *score)) differences.push_back(l - r);
  return sample_over(differences);
}

std::vector<double> batches_of(const CellAnalysis* cell, const std::string& metric,
                               std::uint64_t runs, BatchBand band) {
  if (cell == nullptr || runs == 0) return {};
  if (const auto joint = find_name(kJoint, metric); joint != std::end(kJoint)) {
    return joint_batches(*cell, *joint, runs, band);
  }
  const Score* score = find_score(metric);
  std::vector<double> means;
  if (score == nullptr) return means;
  const std::span<const double> values = cell->scores.column(score->name);
  for (std::size_t first = 0; first + runs <= values.size(); first += runs) {
    means.push_back(sample_over(values.subspan(first, runs)).mean);
  }
  return means;
}

Interval interval_of(const Sample& sample, double level) {
  if (sample.n < 2) return {kNaN, kNaN};
  const double half =
      t_quantile(sample.n, level) * sample.sd / std::sqrt(static_cast<double>(sample.n));
  return {sample.mean - half, sample.mean + half};
}

std::string metric_in_words(const std::string& metric) {
  if (const auto joint = find_name(kJoint, metric); joint != std::end(kJoint)) return joint->words;
  const Score* score = find_score(metric);
  if (score == nullptr) return metric;
  const std::string units = score->units;
  return score->words + (units == "1" ? "" : " [" + units + "]");
}

bool is_run_metric(const std::string& metric) { return find_score(metric) != nullptr; }

std::vector<std::string> printed_metrics() {
  std::vector<std::string> names;
  for (const Score& score : all_scores()) names.emplace_back(score.name);
  for (const JointName& joint : kJoint) names.emplace_back(joint.name);
  return names;
}

}  // namespace montecarta::analysis
