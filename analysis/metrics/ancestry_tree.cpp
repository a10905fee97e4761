// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/ancestry_tree.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace montecarta::analysis {
namespace {

using Branch = AncestryTree::Branch;
constexpr std::size_t kNoBranch = AncestryTree::kNone;

/// Walks from the last scan to the first; `alive` are the branches that are being followed.
class Walk {
 public:
  Walk(AncestryTree& tree, std::size_t particles, std::size_t most, double end)
      : tree_(tree), child_count_(particles), open_(particles, kNoBranch) {
    tree_.particles = particles;
    tree_.leaves = std::min(particles, most);
    for (std::size_t k = 0; k < tree_.leaves; ++k) {
      tree_.branches.push_back({kNoBranch, 0.0, end, 1, 0.0});
      alive_.emplace_back(static_cast<std::uint32_t>(k * particles / tree_.leaves), k);
    }
  }

  bool is_over() const { return alive_.size() < 2; }

  /// From particles to their parents, which lived at `time`.
  void step_back(std::span<const std::uint32_t> parents, double time) {
    for (auto& [particle, branch] : alive_) {
      particle = parents[particle];
      expect_particle(particle);
      ++child_count_[particle];
    }
    for (const auto& [particle, branch] : alive_) {
      if (child_count_[particle] > 1) join(particle, branch, time);
    }
    forget_joined();
  }

 private:
  using Line = std::pair<std::uint32_t, std::size_t>;  ///< (particle, branch)

  void expect_particle(std::uint32_t particle) const {
    if (particle < child_count_.size()) return;
    throw RunError("ancestor: parent " + std::to_string(particle) + " of " +
                   std::to_string(child_count_.size()) +
                   " particles (the column is damaged): run the study again");
  }

  void join(std::uint32_t particle, std::size_t branch, double time) {
    if (open_[particle] == kNoBranch) {
      open_[particle] = tree_.branches.size();
      tree_.branches.push_back({kNoBranch, 0.0, time, 0, 0.0});
    }
    tree_.branches[branch].parent = open_[particle];
    tree_.branches[branch].from = time;
    tree_.branches[open_[particle]].leaves += tree_.branches[branch].leaves;
  }

  /// Each parent once, with the branch that leads to it.
  void forget_joined() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < alive_.size(); ++i) {
      const auto [particle, branch] = alive_[i];
      if (child_count_[particle] == 0) continue;
      child_count_[particle] = 0;
      alive_[kept++] = {particle, std::exchange(open_[particle], kNoBranch) == kNoBranch
                                      ? branch
                                      : tree_.branches[branch].parent};
    }
    alive_.resize(kept);
  }

  AncestryTree& tree_;
  std::vector<Line> alive_;
  std::vector<std::uint32_t> child_count_;  ///< {particle} that are alive; zero between steps
  std::vector<std::size_t> open_;           ///< {particle} the branch that forks there
};

/// Where lines are drawn: small families below large ones, parents half way between their first and
/// last child.
void set_heights(AncestryTree& tree) {
  std::vector<Branch>& branches = tree.branches;
  std::vector<std::vector<std::size_t>> children(branches.size() + 1);  // last: of the start
  for (std::size_t b = 0; b < branches.size(); ++b) {
    children[std::min(branches[b].parent, branches.size())].push_back(b);
  }
  std::vector<double> below(branches.size() + 1, 0.0);  // leaves below a branch's own
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
  Walk walk(tree, particles, most, times.back());
  for (std::size_t s = times.size(); s-- > 0 && !walk.is_over();) {
    walk.step_back(ancestor.subspan(s * particles, particles), s == 0 ? 0.0 : times[s - 1]);
  }
  set_heights(tree);
  return tree;
}

}  // namespace montecarta::analysis
