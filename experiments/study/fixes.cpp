// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/fixes.hpp"

#include "engine/errors.hpp"
#include "experiments/text/words.hpp"

#include <cmath>

namespace montecarta::experiments {
namespace {

bool has_fixes(const Settings& settings) {
  return settings.has("scenario", "fixes") && settings.text("scenario", "fixes") == "position";
}

}  // namespace

std::uint32_t scans_per_fix(const Settings& settings) {
  if (!has_fixes(settings)) return 0;
  const double ratio =
      settings.number("scenario", "scan_rate") / settings.number("scenario", "fix_rate");
  const double whole = std::round(ratio);
  if (whole >= 1.0 && std::abs(ratio - whole) <= 1e-9 * whole)
    return static_cast<std::uint32_t>(whole);
  throw StudyError(
      "{}: fix_rate does not divide scan_rate ({} scans a fix): choose rates whose ratio is a "
      "whole number",
      settings.place("scenario", "fix_rate"), to_text(ratio));
}

std::optional<double> believed_sigma_fix(const Settings& settings) {
  if (!has_fixes(settings)) return std::nullopt;
  return settings.number("belief", "sigma_fix");
}

void refuse_fixes(const Settings& settings, std::span<const CellSpec> cells,
                  std::span<const FilterKind> filters) {
  if (!has_fixes(settings)) return;
  for (const CellSpec& cell : cells) {
    if (cell.filter->takes_fixes) continue;
    throw StudyError(
        "{}: {} with scenario.fixes = position (it takes detections of landmarks only): use one of "
        "{}, or set scenario.fixes = none",
        cell.place, cell.filter->name, filters_that(filters, &FilterKind::takes_fixes));
  }
}

}  // namespace montecarta::experiments
