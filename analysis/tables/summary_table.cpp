// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/tables/summary_table.hpp"

#include "analysis/output/number_text.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/numbers/angle.hpp"

#include <algorithm>

namespace montecarta::analysis {
namespace {

constexpr double kDegreesOfARadian = 180.0 / kPi;

/// "40", or "32 of 200" where runs failed, are missing or were not needed.
std::string complete_runs(const CellAnalysis& cell) {
  const std::size_t all = cell.complete + cell.failures.size() + cell.missing + cell.spared;
  const std::string complete = std::to_string(cell.complete);
  return cell.complete == all ? complete : complete + " of " + std::to_string(all);
}

TableRow summary_row(const CellAnalysis& cell) {
  const Verdict& verdict = cell.verdict;
  const bool is_tested = verdict.answer != Answer::untested;
  return {cell.label,
          complete_runs(cell),
          name_of(verdict.answer),
          is_tested ? with_interval(verdict.ratio_estimate(), verdict.ratio()) : "-",
          readable(cell.over_runs("position_rmse").mean),
          readable(kDegreesOfARadian * cell.over_runs("heading_rmse").mean),
          readable(cell.over_runs("ancestors_at_start_at_the_end").mean),
          readable(cell.over_runs("cpu_seconds").mean, 2)};
}

/// Leaves out columns in which all cells say `text`.
void leave_out_columns(const std::string& text, TextTable& table) {
  for (std::size_t c = table.headings.size(); c-- > 1;) {
    if (!std::ranges::all_of(table.rows, [&](const TableRow& row) { return row[c] == text; })) {
      continue;
    }
    const auto place = static_cast<std::ptrdiff_t>(c);
    table.headings.erase(table.headings.begin() + place);
    for (TableRow& row : table.rows) row.erase(row.begin() + place);
  }
}

}  // namespace

TextTable summary_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left},
                    {"complete"},
                    {"verdict", Align::left},
                    {"NEES ratio [" + level_text(study.level) + "]"},
                    {"RMSE [m]"},
                    {"RMSE [deg]"},
                    {"ancestors"},
                    {"CPU [s]"}};
  for (const CellAnalysis& cell : study.cells) table.rows.push_back(summary_row(cell));
  leave_out_columns("-", table);
  leave_out_columns(std::to_string(study.runs_here), table);
  return table;
}

}  // namespace montecarta::analysis
