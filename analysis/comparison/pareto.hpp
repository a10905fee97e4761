// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/figure.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Cost and merit of something, less is better in both.
struct Offer {
  double cost = 0.0;
  double loss = 0.0;
};

/// Whether each offer is on the Pareto front: no other is better in one and at least as good in the
/// other. What is not a number is never on it.
std::vector<bool> pareto_front(std::span<const Offer> offers);

/// What a cell costs and what it gives, over its complete runs.
struct CellValue {
  std::string cell;
  std::size_t place = 0;   ///< among the study's cells
  std::size_t failed = 0;  ///< runs, which are in none of the numbers
  Summary cpu_seconds;
  Summary position_rmse;             ///< [m]
  std::string verdict;               ///< on the pose, in words
  double nees_distance = 0.0;        ///< |log2(ANEES / components)| of the pose (nees_distance())
  bool accurate_for_cost = false;    ///< on the front of position RMSE against CPU time
  bool consistent_for_cost = false;  ///< on the front of NEES distance against CPU time
};

/// Of the cells with complete runs; none where nobody knows the true path.
std::vector<CellValue> cell_values(const StudyAnalysis& study);

/// Position RMSE and NEES distance against CPU time of a run, a labelled point a cell, with both
/// Pareto fronts. Without data where fewer than two cells have a cost.
Figure pareto_figure(std::span<const CellValue> values);

}  // namespace montecarta::analysis
