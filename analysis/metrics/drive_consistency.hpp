// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/drive_scores.hpp"
#include "analysis/verdict/verdict.hpp"

#include <span>
#include <string>

namespace montecarta::analysis {

/// What all runs of a cell say by one reference. Where they met the same drive they differ by the
/// filter's random numbers alone, and many say no more of the drive than one; where each met its
/// own they are independent.
struct DriveConsistency {
  Answer answer = Answer::untested;
  double within = kUsualMargin;
  DriveScores mean;        ///< means over runs; of counts and flags the largest
  double minutes = 0.0;    ///< of driving like this that decide; infinite where none does
  std::size_t drives = 0;  ///< of their own that were judged; 0: all runs met one
};

/// `runs` of one cell and reference. Untested where there are none, no fix can be judged, or the
/// estimate is the reference itself.
DriveConsistency judge_drive(std::span<const DriveScores> runs, double level, double within);

/// Likewise of runs that each met a drive of its own, with DriveScores::errors. Of the mean fixes,
/// seconds and counts are sums. Drives without a fix that can be judged are left out.
DriveConsistency judge_own_drives(std::span<const DriveScores> runs, double level, double within);

/// "consistent within 1.1", "optimistic by 1.3 to 2.1", "this drive cannot tell: it would need 40
/// minutes", ...
std::string in_words(const DriveConsistency& drive);

}  // namespace montecarta::analysis
