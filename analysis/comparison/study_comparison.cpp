// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/comparison/study_comparison.hpp"

#include <utility>

namespace montecarta::analysis {

StudyComparison compare_study(const StudyAnalysis& study, const std::string& baseline,
                              std::span<const Score* const> scores) {
  StudyComparison comparison{compare_cells(study, baseline, scores), {}, cell_values(study)};
  for (const Score* score : scores) {
    WinMatrix matrix = win_matrix(study, *score);
    if (matrix.cells.size() > 1) comparison.matrices.push_back(std::move(matrix));
  }
  return comparison;
}

}  // namespace montecarta::analysis
