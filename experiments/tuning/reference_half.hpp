// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/drive_scores.hpp"
#include "analysis/run/path_at_fixes.hpp"
#include "analysis/run/run_rows.hpp"
#include "experiments/tuning/filter_on_drive.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace montecarta::experiments {

/// The first half of a drive's scans, by which noise is chosen, or the second one, which confirms.
enum class DriveHalf { first, second };

/// The reference by which noise is chosen: the first one that states its errors or, if none does,
/// the first one; nullptr if there is none.
const ReferencePath* reference_to_tune_by(const Itinerary& itinerary);

/// The fixes of reference_to_tune_by() in one half of a recorded drive. A reference that states no
/// errors counts as exact, to a micrometre and a microradian. Filters are judged there by their
/// estimates after every step, as analyze judges them with record.rate = control.
class ReferenceHalf {
 public:
  /// The itinerary must have a reference. The drive has the prior of the start, if there is one.
  ReferenceHalf(const Itinerary& itinerary, const Drive& drive, DriveHalf half);

  const PathAtFixes& fixes() const { return fixes_; }
  /// Number of scans after which no estimate is needed.
  std::size_t scans() const { return scans_; }
  /// The estimates of a filter that is run on `part`, which has scans() scans. Rows of steps that
  /// no fix needs are zero. Returns nullopt if the filter fails.
  std::optional<RunRows> estimates_on(const DrivePart& part, SlamFilter& filter) const;
  /// The log scores of estimates_on() at the fixes (STATISTICS 23), in their order, without those
  /// at which the estimate has no usable covariance.
  std::vector<double> log_scores(const RunRows& estimates) const;
  /// The scores of the NEES at the fixes (STATISTICS 20).
  DriveScores drive_scores(const Itinerary& itinerary, const RunRows& estimates,
                           std::size_t particles) const;

 private:
  ReferenceHalf(const Itinerary& itinerary, const Drive& drive, DriveHalf half, std::size_t scans);

  std::size_t scans_;
  std::size_t steps_;
  PathAtFixes fixes_;
  std::vector<bool> is_needed_;  ///< {step} whether a fix lies beside the end of the step
};

/// Throws StudyError if the errors of a filter at the fixes are far larger than it claims, and as
/// large as the way itself: no noise explains that, but another unit or another frame does.
/// `place` begins the message.
void refuse_strange_reference(const ReferenceHalf& half, const RunRows& estimates,
                              const std::string& place);

}  // namespace montecarta::experiments
