// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/time_units.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "experiments/judging/scan_clock.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

namespace montecarta::experiments {
namespace {

/// A unit in which clocks count.
struct ClockUnit {
  const char* name;
  const char* factor;  ///< text of `in_a_second`
  double in_a_second;
  double least_since_1970;  ///< times since 1970 in this unit are larger, times in s smaller
};

constexpr std::array<ClockUnit, 3> kUnits = {
    {{"ns", "1e9", 1e9, 1e17}, {"us", "1e6", 1e6, 1e14}, {"ms", "1e3", 1e3, 1e11}}};

/// [s] Rows farther apart are not in s: 12 days, or 1 ms in ns.
constexpr double kFarthestRows = 1e6;
/// [s] Rows farther apart may be in us: 3 hours, or 10 ms in us.
constexpr double kFarRows = 1e4;

/// The usual difference between neighbouring times; 0 if there is one row.
double spacing_of(const std::vector<double>& times) {
  return times.size() < 2 ? 0.0 : usual_spacing(times);
}

std::string place_of_first(const StateRows& rows, const std::filesystem::path& path) {
  return formatted("{}:{}", path, rows.line.front());
}

/// Whether most times have a truth of nearly the same time.
bool are_mostly_found(const std::vector<double>& times, const std::vector<double>& truth) {
  const double near = 0.01 * std::min(spacing_of(truth), spacing_of(times));
  const auto is_found = [&](double time) {
    const auto after = std::ranges::lower_bound(truth, time - near);
    return after != truth.end() && *after <= time + near;
  };
  return 2 * std::ranges::count_if(times, is_found) > std::ssize(times);
}

/// Whether times lie in most of the truth's time if they are multiplied by `factor`, and not
/// otherwise.
bool is_factor(const std::vector<double>& times, double factor, const std::vector<double>& truth) {
  const double of_truth = truth.back() - truth.front(), slack = 0.1 * of_truth;
  const bool is_inside = factor * times.front() >= truth.front() - slack &&
                         factor * times.back() <= truth.back() + slack;
  if (!is_inside || factor * (times.back() - times.front()) < 0.5 * of_truth) return false;
  if (factor > 1.0 && spacing_of(truth) <= spacing_of(times)) return false;
  return !are_mostly_found(times, truth);
}

}  // namespace

void require_seconds(const StateRows& rows, const std::filesystem::path& path) {
  if (rows.time.empty()) return;
  const double largest = std::max(std::abs(rows.time.front()), std::abs(rows.time.back()));
  const double spacing = spacing_of(rows.time);
  const auto unit = std::ranges::find_if(
      kUnits, [&](const ClockUnit& one) { return largest >= one.least_since_1970; });
  if (unit == kUnits.end() && spacing <= kFarthestRows) return;
  const ClockUnit& likely = unit == kUnits.end() ? kUnits.front() : *unit;
  const std::string rows_apart =
      spacing > 0.0 ? formatted(", and rows are {} s apart", to_text(spacing)) : "";
  throw StudyError(
      "{}: time_s {} is not in s (it looks like {}{}): divide time_s by {}, in this file and in "
      "others with its clock",
      place_of_first(rows, path), to_text(rows.time.front()), likely.name, rows_apart,
      likely.factor);
}

std::string note_on_times(const StateRows& rows, const std::filesystem::path& path) {
  const double spacing = spacing_of(rows.time);
  if (spacing < kFarRows) return "";
  return formatted(
      "{}: rows are {} s apart (they are judged so): if time_s is in us, divide it by 1e6",
      place_of_first(rows, path), to_text(spacing));
}

void require_same_time_unit(const StateRows& rows, const std::filesystem::path& estimates,
                            const StateRows& truth, const std::filesystem::path& truths) {
  if (rows.time.size() < 2 || truth.time.size() < 2) return;
  for (const ClockUnit& unit : kUnits) {
    const bool is_truth = is_factor(rows.time, unit.in_a_second, truth.time);
    if (!is_truth && !is_factor(rows.time, 1.0 / unit.in_a_second, truth.time)) continue;
    const std::string &wrong = is_truth ? truths.string() : estimates.string(),
                      &right = is_truth ? estimates.string() : truths.string();
    throw StudyError(
        "{}: times look like {} (they are {} times those of {}): divide its time_s by {}", wrong,
        unit.name, unit.factor, right, unit.factor);
  }
}

}  // namespace montecarta::experiments
