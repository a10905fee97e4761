// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/comparison/win_matrix.hpp"

#include "analysis/metrics/paired_runs.hpp"

#include <utility>

namespace montecarta::analysis {
namespace {

Wins seen_from_the_other(Wins wins) {
  std::swap(wins.won, wins.lost);
  return wins;
}

/// Each pair is one test, whichever side it is seen from.
void adjust(WinMatrix& matrix) {
  const std::size_t n = matrix.cells.size();
  std::vector<double> p;
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t c = r + 1; c < n; ++c) p.push_back(matrix.wins[r][c].p);
  }
  const std::vector<double> adjusted = holm(p);
  auto next = adjusted.begin();
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t c = r + 1; c < n; ++c) {
      matrix.wins[r][c].p_holm = matrix.wins[c][r].p_holm = *next++;
    }
  }
}

}  // namespace

WinMatrix win_matrix(const StudyAnalysis& study, const Score& score) {
  WinMatrix matrix{&score, {}, {}};
  std::vector<const CellAnalysis*> cells;
  for (const CellAnalysis& cell : study.cells) {
    if (!is_judged_by(cell, score)) continue;
    cells.push_back(&cell);
    matrix.cells.push_back(cell.label);
  }
  matrix.wins.assign(cells.size(), std::vector<Wins>(cells.size()));
  for (std::size_t r = 0; r < cells.size(); ++r) {
    for (std::size_t c = r + 1; c < cells.size(); ++c) {
      matrix.wins[r][c] = wins_of(*cells[r], *cells[c], score);
      matrix.wins[c][r] = seen_from_the_other(matrix.wins[r][c]);
    }
  }
  adjust(matrix);
  return matrix;
}

}  // namespace montecarta::analysis
