// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/anchor.hpp"
#include "experiments/judging/error_convention.hpp"
#include "experiments/judging/state_rows.hpp"
#include "experiments/judging/truth_path.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// Moves the truths of runs onto their first estimates, and judges what the covariances of the
/// moved errors are (STATISTICS 19). All runs are surveyed before the first one is moved.
class AnchoredRuns {
 public:
  AnchoredRuns(Anchor anchor, ErrorConvention convention, std::size_t cells)
      : anchor_(anchor), convention_(convention), cells_(cells) {}

  /// Looks at a run of a cell: how uncertain its anchor is, beside its later estimates.
  void survey(std::size_t cell, const StateRows& estimates, const std::filesystem::path& path,
              std::vector<std::optional<TrueState>> truths);
  /// {cell} Whether the anchor of one of its runs is so uncertain that covariances of moved errors
  /// are only bounds.
  std::vector<bool> are_bounded() const;
  /// Moves the truths of a run that was surveyed, and removes the truth of its anchor. In a bounded
  /// cell `estimates` get the bounds as covariances; else estimates so soon after the anchor that
  /// its error is not small beside theirs lose their truth.
  void move(std::size_t cell, StateRows& estimates, const std::filesystem::path& path,
            std::vector<std::optional<TrueState>>& truths);
  /// Notes on cells with these labels.
  std::vector<std::string> notes(const std::vector<std::string>& labels) const;

 private:
  struct AnchoredCell {
    bool is_bounded = false;
    std::uint64_t removed = 0;  ///< estimates that lost their truth
    double deviation = 0.0;     ///< of the most uncertain moved component at an anchor
    std::string of_deviation;   ///< its component and file
  };

  Anchor anchor_;
  ErrorConvention convention_;
  std::vector<AnchoredCell> cells_;
};

}  // namespace montecarta::experiments
