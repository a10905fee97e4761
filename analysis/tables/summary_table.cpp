// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/tables/summary_table.hpp"

#include "analysis/metrics/verdict_table.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/numbers/angle.hpp"

#include <algorithm>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kComplete = 1;  // the column of complete runs

/// "40", or "32 of 200" where runs failed, are missing or were not needed.
std::string complete_runs(const CellAnalysis& cell) {
  const std::size_t all = cell.complete + cell.failures.size() + cell.missing + cell.spared;
  const std::string complete = std::to_string(cell.complete);
  return cell.complete == all ? complete : complete + " of " + std::to_string(all);
}

/// "1.0 of 100": first particles that still have descendants at the end.
std::string ancestors_text(const CellAnalysis& cell) {
  const std::string count = readable(cell.over_runs("ancestors_at_start_at_the_end").mean, 2);
  return count == "-" ? count : count + " of " + std::to_string(cell.particles);
}

std::vector<TextTable::Entry> summary_row(const CellAnalysis& cell, double level) {
  return {{"cell", cell.label, Align::left},
          {"complete", complete_runs(cell)},
          {"verdict", name_of(cell.verdict.answer), Align::left},
          {"NEES ratio [" + level_text(level) + "]", ratio_text(cell)},
          {"RMSE [m]", readable(cell.over_runs("position_rmse").mean)},
          {"RMSE [deg]", readable(180.0 / kPi * cell.over_runs("heading_rmse").mean)},
          {"ancestors", ancestors_text(cell)},
          {"CPU/run [s]", readable(cell.over_runs("cpu_seconds").mean, 2)}};
}

/// Leaves out column `c` if all cells say `text` in it.
void leave_out(std::size_t c, const std::string& text, TextTable& table) {
  if (!std::ranges::all_of(table.rows, [&](const TableRow& row) { return row[c] == text; })) return;
  const auto place = static_cast<std::ptrdiff_t>(c);
  table.headings.erase(table.headings.begin() + place);
  for (TableRow& row : table.rows) row.erase(row.begin() + place);
}

}  // namespace

TextTable summary_table(const StudyAnalysis& study) {
  TextTable table;
  for (const CellAnalysis& cell : study.cells) table.add(summary_row(cell, study.level));
  for (std::size_t c = table.headings.size() - 1; c > kComplete; --c) leave_out(c, "-", table);
  leave_out(kComplete, std::to_string(study.runs_here), table);
  return table;
}

}  // namespace montecarta::analysis
