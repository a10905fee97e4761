// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/doubles/scripted_drives.hpp"
#include "tests/doubles/scripted_filter.hpp"

#include <vector>

namespace montecarta::engine {

/// A scripted filter that keeps the fixes which it is given.
class FilterWithFixes final : public ScriptedFilter {
 public:
  explicit FilterWithFixes(std::vector<PositionFix>& taken) : ScriptedFilter({}), taken_(&taken) {}
  void take_fix(const PositionFix& fix) override { taken_->push_back(fix); }

 private:
  std::vector<PositionFix>* taken_;
};

/// The drive of run 0, with the fix (s, -s) at every scan s with an odd number.
inline Drive drive_with_fixes(const DriveSource& drives) {
  Drive drive;
  drives.generate(0, drive);
  drive.fixes.resize(drives.itinerary().scans());
  for (std::size_t s = 1; s < drive.fixes.size(); s += 2)
    drive.fixes[s] = PositionFix(static_cast<double>(s), -static_cast<double>(s));
  return drive;
}

}  // namespace montecarta::engine
