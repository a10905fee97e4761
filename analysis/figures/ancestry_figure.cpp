// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/ancestry_figure.hpp"

#include "analysis/data/run_reader.hpp"
#include "analysis/figures/path_data.hpp"
#include "analysis/metrics/ancestry_tree.hpp"
#include "analysis/output/number_text.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kMostTrees = 8, kMostLeaves = 100;

/// A cell that is drawn.
struct DrawnTree {
  std::string label;
  std::size_t style = 0;
  AncestryTree tree;
  double end = 0.0;  ///< [s] of the run
};

std::vector<DrawnTree> drawn_trees(const ResultFile& file, std::size_t run) {
  std::vector<DrawnTree> drawn;
  for (std::size_t c = 0; c < file.cells().size() && drawn.size() < kMostTrees; ++c) {
    const StoredCell& cell = file.cells()[c];
    if (cell.particles < 2 || !cell.has("ancestor")) continue;
    if (file.status(cell)[run] != RunStatus::complete) continue;
    const RunRows rows = read_run(file, cell, run);
    const auto times = drive_met_by(file, file.runs()[run]).scan_times;
    drawn.push_back({cell.label, c,
                     ancestry_tree(rows.ancestor, cell.particles, times, kMostLeaves),
                     times.back()});
  }
  return drawn;
}

/// A row for every branch. A line that comes from the start has no height there but its own.
FigureData data_of(const DrawnTree& cell) {
  FigureData data{"ancestry_" + cell.label + ".csv",
                  {"from [s]", "to [s]", "height", "height of its parent", "leaves"},
                  {}};
  for (const AncestryTree::Branch& branch : cell.tree.branches) {
    const bool is_root = branch.parent == AncestryTree::kNone;
    data.rows.push_back({branch.from, branch.to, branch.height,
                         is_root ? branch.height : cell.tree.branches[branch.parent].height,
                         static_cast<double>(branch.leaves)});
  }
  return data;
}

std::string title_of(const DrawnTree& cell) {
  const AncestryTree& tree = cell.tree;
  return cell.label + ": " +
         (tree.leaves < tree.particles ? std::to_string(tree.leaves) + " of " : "") +
         std::to_string(tree.particles) + " particles";
}

/// What the youngest common ancestor says of the run.
std::string title_of_end(const DrawnTree& cell) {
  const double since = cell.tree.common_ancestor();
  if (since == 0.0) return "no common ancestor since the start";
  return "common ancestor " + readable(cell.end - since, 3) + " s before the end";
}

/// The tree as one line with gaps: from its parent's height to its own, and on to its end.
ChartMarks lines_of(const DrawnTree& cell, const FigureData& data) {
  constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
  ChartMarks lines;
  lines.cell = cell.label;
  lines.style = cell.style;
  lines.facts = {{"from [s]", {}}, {"to [s]", {}}, {"descendants at the end", {}}};
  for (const auto& row : data.rows) {
    const double from = row[0], to = row[1], height = row[2], parent = row[3], leaves = row[4];
    lines.x.insert(lines.x.end(), {from, from, to, kGap});
    lines.y.insert(lines.y.end(), {parent, height, height, kGap});
    for (int corner = 0; corner < 4; ++corner) {
      const bool is_gap = corner == 3;
      lines.facts[0].values.push_back(is_gap ? kGap : from);
      lines.facts[1].values.push_back(is_gap ? kGap : to);
      lines.facts[2].values.push_back(is_gap ? kGap : leaves);
    }
  }
  return lines;
}

ChartPanel chart_panel(const DrawnTree& cell, const FigureData& data) {
  const bool some = cell.tree.leaves < cell.tree.particles;
  ChartPanel panel{(some ? title_of(cell) : cell.label) + ", " + title_of_end(cell),
                   {false, 0.0, static_cast<double>(cell.tree.leaves + 1)},
                   {},
                   {},
                   {},
                   cell.label};
  panel.marks.push_back(lines_of(cell, data));
  return panel;
}

/// Where the second panel of a row begins: shortly before the youngest common ancestor.
double begin_of_resolved(const DrawnTree& cell) {
  const double since = cell.tree.common_ancestor();
  return std::max(0.0, since - 0.08 * (cell.end - since));
}

}  // namespace

Figure ancestry_figure(const ResultFile& file, std::optional<std::uint64_t> run) {
  Figure figure{"ancestry", "Whose story do the particles tell?", ""};
  const auto run_index = chosen_run(file, run);
  const auto cells = run_index ? drawn_trees(file, *run_index) : std::vector<DrawnTree>{};
  if (cells.empty()) return figure;
  figure.sentence =
      "Run " + std::to_string(file.runs()[*run_index]) +
      ": the lines of descent of the particles at the end of the run (right edge); lines meet in "
      "a common ancestor, and to the left of the last meeting all particles share one past: what "
      "the filter got wrong there it cannot doubt any more.";
  const double end = cells.front().end;
  figure.chart.x_to = figure.chart.x_first = end;
  figure.chart.height = 150.0;
  for (const DrawnTree& cell : cells) {
    figure.data.push_back(data_of(cell));
    figure.chart.panels.push_back(chart_panel(cell, figure.data.back()));
    if (cell.tree.common_ancestor() == 0.0) continue;  // nothing to enlarge
    figure.chart.x_first = std::min(figure.chart.x_first, begin_of_resolved(cell));
  }
  if (figure.chart.x_first < end) {
    figure.sentence += " The end of the run, since the earliest of these meetings, is enlarged.";
  } else {
    figure.chart.x_first = 0.0;
  }
  return figure;
}

}  // namespace montecarta::analysis
