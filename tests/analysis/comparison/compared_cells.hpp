// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {

/// A cell whose runs 0, 1, ... have these position RMSEs and as many seconds of CPU time; a
/// negative one is a run that failed.
inline CellAnalysis compared_cell(const std::string& label, const std::vector<double>& rmse,
                                  double cpu_seconds = 1.0) {
  CellAnalysis cell;
  cell.label = label;
  for (std::size_t i = 0; i < rmse.size(); ++i) {
    if (rmse[i] < 0.0) {
      cell.failures.push_back({i, 0, "lost"});
      continue;
    }
    const ScoreTable::Value scores[] = {{"position_rmse", rmse[i]}, {"cpu_seconds", cpu_seconds}};
    cell.runs.push_back(i);
    cell.scores.add(scores);
  }
  cell.complete = cell.runs.size();
  return cell;
}

inline StudyAnalysis compared_study(std::vector<CellAnalysis> cells) {
  StudyAnalysis study;
  study.file = "study.h5";
  study.cells = std::move(cells);
  return study;
}

}  // namespace montecarta::analysis
