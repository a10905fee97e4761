// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/drive_scores.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/core/judgement.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Verdict on a cell by one reference. Runs on the same drive differ only by the filter's random
/// numbers, so many of them contain no more information about the drive than one; runs on drives of
/// their own are independent.
struct DriveConsistency {
  Answer answer = Answer::untested;
  double within = kUsualMargin;
  /// Means over runs. in_gaps, undefined and outliers are the largest of any run, fixes the
  /// smallest, and a flag is set if any run has it.
  DriveScores mean;
  double minutes = 0.0;    ///< length of such a drive that decides the verdict; may be infinite
  std::size_t drives = 0;  ///< number of drives judged; 0 if all runs process one drive
};

/// {reference with known errors} Verdict on one cell by each reference.
using DriveConsistencies = std::vector<DriveConsistency>;

/// Judges runs of one cell on the same drive. The answer is untested if there are no runs, if no
/// fix can be judged, or if the estimate is the reference itself.
DriveConsistency judge_drive(std::span<const DriveScores> runs, double level, double within);

/// Judges runs on drives of their own, with DriveScores::errors. In `mean`, fixes, seconds and
/// counts are sums. Drives without a fix that can be judged are left out.
DriveConsistency judge_own_drives(std::span<const DriveScores> runs, double level, double within);

/// The verdict in words: "consistent within 1.1", "optimistic: NEES 1.3 to 2.1 times too large",
/// "this drive cannot tell: it would need 40:00 min", ...
std::string in_words(const DriveConsistency& drive);

}  // namespace montecarta::analysis
