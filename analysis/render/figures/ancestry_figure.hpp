// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/figure.hpp"
#include "engine/records/result_file.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// The lines of descent of one run that reach its end. Only their common ancestors are kept, so the
/// size of the tree depends on the number of particles, not on the length of the run.
struct AncestryTree {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  /// A line of descent between two forks.
  struct Branch {
    /// Index of the parent branch; kNone if it begins where the run begins.
    std::size_t parent = kNone;
    /// [s] times of separation from its siblings, and of its fork or end.
    double from = 0.0, to = 0.0;
    std::size_t leaves = 0;  ///< number of its descendants at the end of the run
    double height = 0.0;     ///< vertical position: leaves at 1, 2, ..., so that no lines cross
  };
  std::vector<Branch> branches;  ///< branches, in which children come before their parents
  std::size_t leaves = 0;        ///< number of lines that are followed back
  /// Number of particles of the cell: more than `leaves` if there are too many.
  std::size_t particles = 0;

  /// [s] Time of the youngest common ancestor of all leaves; 0 if it is the start.
  double common_ancestor() const;
};

/// Follows at most `most` particles of the last scan, evenly over their indices, back through
/// `ancestor` {scan, particle}; `times` [s] of the scans.
AncestryTree ancestry_tree(std::span<const std::uint32_t> ancestor, std::size_t particles,
                           std::span<const double> times, std::size_t most);

/// A figure of the lines of descent of the particles at the end of one run (chosen_run()), cell by
/// cell. It has no data if no cell has stored its ancestry.
Figure ancestry_figure(const ResultFile& file, std::optional<std::uint64_t> run);

}  // namespace montecarta::analysis
