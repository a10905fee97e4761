// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/figures/ancestry_figure.hpp"

#include "analysis/render/figures/path_figure.hpp"
#include "analysis/run/run_reader.hpp"
#include "engine/errors.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace montecarta::analysis {
namespace {

using Branch = AncestryTree::Branch;
constexpr std::size_t kNoBranch = AncestryTree::kNone;

/// Walks from the last scan to the first; `alive_` are the lines that are being followed.
class BranchTracer {
 public:
  BranchTracer(AncestryTree& tree, std::size_t particles, std::size_t most, double end)
      : tree_(tree), child_count_(particles), open_(particles, kNoBranch) {
    tree_.particles = particles;
    tree_.leaves = std::min(particles, most);
    for (std::size_t k = 0; k < tree_.leaves; ++k) {
      tree_.branches.push_back({kNoBranch, 0.0, end, 1, 0.0});
      alive_.push_back({static_cast<std::uint32_t>(k * particles / tree_.leaves), k});
    }
  }

  bool is_over() const { return alive_.size() < 2; }

  /// Steps from particles to their parents, which existed at `time`. Lines that share a parent
  /// become the branch that leads to it.
  void step_back(std::span<const std::uint32_t> parents, double time) {
    for (const DrawnLine& line : alive_) ++child_count_[parents[line.particle]];
    std::vector<DrawnLine> before;
    for (const auto& [particle, branch] : alive_) {
      const std::uint32_t parent = parents[particle];
      if (child_count_[parent] == 1) {
        before.push_back({parent, branch});
        continue;
      }
      if (open_[parent] == kNoBranch) {
        open_[parent] = tree_.branches.size();
        tree_.branches.push_back({kNoBranch, 0.0, time, 0, 0.0});
        before.push_back({parent, open_[parent]});
      }
      tree_.branches[branch].parent = open_[parent];
      tree_.branches[branch].from = time;
      tree_.branches[open_[parent]].leaves += tree_.branches[branch].leaves;
    }
    alive_ = std::move(before);
    for (const DrawnLine& line : alive_) {
      child_count_[line.particle] = 0;
      open_[line.particle] = kNoBranch;
    }
  }

 private:
  struct DrawnLine {
    std::uint32_t particle;
    std::size_t branch;
  };

  AncestryTree& tree_;
  std::vector<DrawnLine> alive_;
  /// {particle} number of followed children; zero between steps.
  std::vector<std::uint32_t> child_count_;
  /// {particle} branch that forks at the particle; kNoBranch if none does.
  std::vector<std::size_t> open_;
};

/// Sets the heights of the lines: small families are below large ones, and parents half way between
/// their first and last child.
void set_heights(AncestryTree& tree) {
  std::vector<Branch>& branches = tree.branches;
  // The last element holds the branches that begin at the start of the run.
  std::vector<std::vector<std::size_t>> children(branches.size() + 1);
  for (std::size_t b = 0; b < branches.size(); ++b) {
    children[std::min(branches[b].parent, branches.size())].push_back(b);
  }
  std::vector<double> below(branches.size() + 1, 0.0);  // {branch} number of leaves drawn below it
  for (std::size_t b = branches.size() + 1; b-- > 0;) {
    std::ranges::stable_sort(children[b], {}, [&](std::size_t c) { return branches[c].leaves; });
    double next = below[b];
    for (const std::size_t child : children[b]) {
      below[child] = next;
      next += static_cast<double>(branches[child].leaves);
    }
  }
  for (std::size_t b = 0; b < branches.size(); ++b) {
    branches[b].height =
        children[b].empty()
            ? below[b] + 1.0
            : 0.5 * (branches[children[b].front()].height + branches[children[b].back()].height);
  }
}

}  // namespace

double AncestryTree::common_ancestor() const {
  return branches.empty() || branches.back().leaves < leaves ? 0.0 : branches.back().to;
}

AncestryTree ancestry_tree(std::span<const std::uint32_t> ancestor, std::size_t particles,
                           std::span<const double> times, std::size_t most) {
  expect(ancestor.size() == times.size() * particles, "ancestors are {scan, particle}");
  AncestryTree tree;
  if (times.empty() || particles == 0 || most == 0) return tree;
  BranchTracer walk(tree, particles, most, times.back());
  for (std::size_t s = times.size(); s-- > 0 && !walk.is_over();) {
    walk.step_back(ancestor.subspan(s * particles, particles), s == 0 ? 0.0 : times[s - 1]);
  }
  set_heights(tree);
  return tree;
}

namespace {

constexpr std::size_t kMostTrees = 8, kMostLeaves = 100;

/// A cell with the tree that is drawn for it.
struct DrawnTree {
  std::string label;
  std::size_t style = 0;
  AncestryTree tree;
  double end = 0.0;  ///< [s] end of the run
};

std::vector<DrawnTree> drawn_trees(const ResultFile& file, std::size_t run) {
  std::vector<DrawnTree> drawn;
  for (std::size_t c = 0; c < file.cells().size() && drawn.size() < kMostTrees; ++c) {
    const StoredCell& cell = file.cells()[c];
    if (cell.particles < 2 || !file.holds(cell, "ancestor", run)) continue;
    if (file.status(cell)[run] != RunStatus::complete) continue;
    const RunRows rows = read_run(file, cell, run);
    const auto times = drive_of_run(file, file.runs()[run]).scan_times;
    drawn.push_back({cell.label, c,
                     ancestry_tree(rows.ancestor, cell.particles, times, kMostLeaves),
                     times.back()});
  }
  return drawn;
}

/// Makes a file with a row for every branch. A line that begins at the start has its own height
/// there.
FigureData data_of(const DrawnTree& cell) {
  FigureData data{"ancestry_" + cell.label + ".csv"};
  for (const AncestryTree::Branch& branch : cell.tree.branches) {
    const bool is_root = branch.parent == AncestryTree::kNone;
    data.frame.add({{"from", "s", branch.from},
                    {"to", "s", branch.to},
                    {"height", "1", branch.height},
                    {"height of its parent", "1",
                     is_root ? branch.height : cell.tree.branches[branch.parent].height},
                    {"leaves", "1", static_cast<double>(branch.leaves)}});
  }
  return data;
}

/// Title of a panel: the cell, how many of its particles are drawn, and the age of their youngest
/// common ancestor.
std::string title_of(const DrawnTree& cell) {
  const AncestryTree& tree = cell.tree;
  const double since = tree.common_ancestor();
  return cell.label +
         (tree.leaves < tree.particles ? ": " + std::to_string(tree.leaves) + " of " +
                                             std::to_string(tree.particles) + " particles"
                                       : "") +
         (since == 0.0
              ? ", no common ancestor since the start"
              : ", common ancestor " + readable(cell.end - since, 3) + " s before the end");
}

/// The tree as one line with gaps; every branch goes from its parent's height to its own, and on to
/// its end.
ChartMarks lines_of(const DrawnTree& cell, const Frame& data) {
  constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
  ChartMarks lines;
  lines.cell = cell.label;
  lines.style = cell.style;
  lines.facts = {{"from [s]", {}}, {"to [s]", {}}, {"descendants at the end", {}}};
  for (std::size_t k = 0; k < data.rows(); ++k) {
    const auto number = [&](std::size_t c) { return data.columns[c].numbers[k]; };
    const double from = number(0), to = number(1), height = number(2), leaves = number(4);
    lines.x.insert(lines.x.end(), {from, from, to, kGap});
    lines.y.insert(lines.y.end(), {number(3), height, height, kGap});
    lines.facts[0].values.insert(lines.facts[0].values.end(), {from, from, from, kGap});
    lines.facts[1].values.insert(lines.facts[1].values.end(), {to, to, to, kGap});
    lines.facts[2].values.insert(lines.facts[2].values.end(), {leaves, leaves, leaves, kGap});
  }
  return lines;
}

ChartPanel chart_panel(const DrawnTree& cell, const Frame& data) {
  ChartPanel panel{
      title_of(cell), {false, 0.0, static_cast<double>(cell.tree.leaves + 1)}, {}, {}, {},
      cell.label};
  panel.marks.push_back(lines_of(cell, data));
  return panel;
}

/// Time [s] at which the second panel of a row begins: shortly before the youngest common ancestor.
double begin_of_resolved(const DrawnTree& cell) {
  const double since = cell.tree.common_ancestor();
  return std::max(0.0, since - 0.08 * (cell.end - since));
}

}  // namespace

Figure ancestry_figure(const ResultFile& file, std::optional<std::uint64_t> run) {
  const auto run_index = chosen_run(file, run);
  const auto cells = run_index ? drawn_trees(file, *run_index) : std::vector<DrawnTree>{};
  if (cells.empty()) return {};
  Figure figure = figure_of("ancestry", {{"run", std::to_string(file.runs()[*run_index])}});
  const double end = cells.front().end;
  figure.chart.x_to = figure.chart.x_first = end;
  figure.chart.height = 150.0;
  for (const DrawnTree& cell : cells) {
    figure.data.push_back(data_of(cell));
    figure.chart.panels.push_back(chart_panel(cell, figure.data.back().frame));
    if (cell.tree.common_ancestor() == 0.0) continue;  // there is nothing to enlarge
    figure.chart.x_first = std::min(figure.chart.x_first, begin_of_resolved(cell));
  }
  if (figure.chart.x_first < end) {
    figure.sentence += " " + prose("ancestry", "enlarged");
  } else {
    figure.chart.x_first = 0.0;
  }
  return figure;
}

}  // namespace montecarta::analysis
