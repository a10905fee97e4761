// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/comparison/pareto.hpp"

#include "analysis/metrics/nees_accumulator.hpp"
#include "analysis/statistics/means.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

bool is_known(const Offer& offer) { return std::isfinite(offer.cost) && std::isfinite(offer.loss); }

bool beats(const Offer& a, const Offer& b) {
  if (!is_known(a)) return false;
  return a.cost <= b.cost && a.loss <= b.loss && (a.cost < b.cost || a.loss < b.loss);
}

CellValue value_of(const CellAnalysis& cell, std::size_t place) {
  return {.cell = cell.label,
          .place = place,
          .failed = cell.failures.size(),
          .cpu_seconds = cell.over_runs("cpu_seconds"),
          .position_rmse = cell.over_runs("position_rmse"),
          .verdict = in_words(cell.consistency()),
          .nees_distance = cell.consistency().verdict == Verdict::untested
                               ? kNaN
                               : nees_distance(cell.consistency().mean, 3)};
}

}  // namespace

std::vector<bool> pareto_front(std::span<const Offer> offers) {
  std::vector<bool> front;
  for (const Offer& offer : offers) {
    const auto beats_it = [&](const Offer& other) { return beats(other, offer); };
    front.push_back(is_known(offer) && std::ranges::none_of(offers, beats_it));
  }
  return front;
}

std::vector<CellValue> cell_values(const StudyAnalysis& study) {
  std::vector<CellValue> values;
  if (!study.has_truth) return values;
  for (std::size_t i = 0; i < study.cells.size(); ++i) {
    if (study.cells[i].complete > 0) values.push_back(value_of(study.cells[i], i));
  }
  std::vector<Offer> accuracy, consistency;
  for (const CellValue& value : values) {
    accuracy.push_back({value.cpu_seconds.mean, value.position_rmse.mean});
    consistency.push_back({value.cpu_seconds.mean, value.nees_distance});
  }
  const std::vector<bool> accurate = pareto_front(accuracy), consistent = pareto_front(consistency);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i].accurate_for_cost = accurate[i];
    values[i].consistent_for_cost = consistent[i];
  }
  return values;
}

}  // namespace montecarta::analysis
