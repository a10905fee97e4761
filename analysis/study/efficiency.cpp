// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/efficiency.hpp"

#include "analysis/study/prose.hpp"

#include <cmath>

namespace montecarta::analysis {
namespace {

double mean_square(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return sum / static_cast<double>(values.size());
}

}  // namespace

Efficiency efficiency_of(const CellAnalysis& cell, const CramerRaoBound& bound) {
  if (bound.empty() || !bound.is_bound || cell.complete == 0) return {};
  return {.position = std::sqrt(mean_square(bound.position) / cell.over_runs("position_mse").mean),
          .heading = std::sqrt(mean_square(bound.heading) / cell.over_runs("heading_mse").mean),
          .map = bound.map / std::sqrt(mean_square(cell.scores.column("landmark_rms")))};
}

std::vector<std::string> bound_notes(const CramerRaoBound& bound) {
  if (bound.empty()) return {prose("bound", "missing", {{"reason", bound.missing}})};
  const std::string runs = std::to_string(bound.runs);
  if (!bound.is_bound) return {prose("bound", "reference", {{"runs", runs}})};
  const std::string paths = bound.runs == 1 ? prose("bound", "one path")
                                            : prose("bound", "many worlds", {{"runs", runs}});
  return {prose("bound", "efficiency", {{"paths", paths}})};
}

}  // namespace montecarta::analysis
