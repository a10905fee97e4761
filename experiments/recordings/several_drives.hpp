// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/recorded_drive.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace montecarta::experiments {

/// Several recorded drives of one scenario: run k meets drive k. Their lengths, starts and fixes
/// are their own; references have the same names and tell the same of themselves, and surveyed
/// landmarks are those of all.
class SeveralDrives final : public DriveSource {
 public:
  /// As RecordedDrive has them; at least one. Throws StudyError where two do not belong together.
  explicit SeveralDrives(std::vector<RecordedDrive> drives);

  const Itinerary& itinerary() const override { return itinerary_; }
  std::size_t own_drives() const override { return drives_.size(); }
  const Itinerary& itinerary_of(std::uint64_t run) const override;
  void generate(std::uint64_t run, Drive& drive) const override;

 private:
  std::vector<RecordedDrive> drives_;
  Itinerary itinerary_;  ///< of the drive with most scans, without references
};

}  // namespace montecarta::experiments
