// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/anchor.hpp"
#include "experiments/judging/error_convention.hpp"
#include "experiments/judging/state_rows.hpp"
#include "experiments/judging/truth_path.hpp"

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
  AnchoredRuns(Anchor anchor, ErrorConvention convention)
      : anchor_(anchor), convention_(convention) {}

  /// Looks at a run: how uncertain its anchor is, beside its later estimates.
  void survey(const StateRows& estimates, const std::filesystem::path& path,
              std::vector<std::optional<TrueState>> truths);
  /// Whether the anchors are so uncertain that covariances of moved errors are only bounds.
  bool are_bounded() const;
  /// Moves the truths of a run that was surveyed, and removes the truth of its anchor. If all
  /// covariances are bounds, `estimates` get them; else estimates so soon after the anchor that
  /// its error is not small beside theirs lose their truth.
  void move(StateRows& estimates, const std::filesystem::path& path,
            std::vector<std::optional<TrueState>>& truths);
  std::vector<std::string> notes() const;

 private:
  Anchor anchor_;
  ErrorConvention convention_;
  std::uint64_t rows_ = 0;     ///< estimates with a truth, behind the anchors
  std::uint64_t near_ = 0;     ///< those beside which the anchor's error is not small
  std::uint64_t removed_ = 0;  ///< those that lost their truth
  double deviation_ = 0.0;     ///< of the most uncertain moved component at an anchor
  std::string of_deviation_;   ///< its component and file
};

}  // namespace montecarta::experiments
