// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/verdict_table.hpp"
#include "analysis/output/number_text.hpp"

namespace montecarta::analysis {

std::vector<std::string> too_few_notes(const StudyAnalysis& study) {
  std::vector<std::string> notes;
  for (const CellAnalysis& cell : study.cells) {
    const NeesResult* pose = cell.find_nees(ErrorBlock::pose, cell.leading);
    if (pose == nullptr || pose->series.too_few == 0) continue;
    const double share =
        static_cast<double>(pose->series.too_few) / static_cast<double>(pose->series.samples);
    notes.push_back(cell.label + ": in " + std::to_string(pose->series.too_few) + " of " +
                    std::to_string(pose->series.samples) + " scans (" + percent(share) +
                    ") the weights leave no more than 5 effective draws (ESS), of which a "
                    "covariance of three components cannot be judged; ANEES and verdict are of "
                    "the other scans.");
  }
  return notes;
}

}  // namespace montecarta::analysis
