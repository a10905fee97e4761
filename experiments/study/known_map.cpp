// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/known_map.hpp"

#include "engine/errors.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <iterator>
#include <vector>

namespace montecarta::experiments {
namespace {

/// Throws StudyError if a true deviation is given that has no effect.
void refuse_deviations(const Settings& settings) {
  for (const char* key : {"map_sigma_m", "start_sigma_m", "start_sigma_deg"}) {
    if (!settings.has("scenario", key) || settings.number("scenario", key) == 0.0) continue;
    throw StudyError(
        "{}: scenario.{} = {} with belief.map = estimated (a filter that estimates the map begins "
        "it at the start, which is exact by definition): set belief.map = known, or remove it",
        settings.place("scenario", key), key, settings.text("scenario", key));
  }
}

/// Says why a filter takes no known map.
std::string reason_against_map(const std::string& filter) {
  struct Reason {
    const char* filters;  ///< part of their names
    const char* text;
  };
  static constexpr Reason kReasons[] = {
      {"dead_reckoning", "it uses no landmarks"},
      {"external", "the protocol of programs has no message for a map"},
      {"fixed_lag", "it begins at an exact first pose, without landmarks"},
      {"equivariant", "it begins at an exact first pose, without landmarks"},
      {"smoother", "it estimates the whole path from an exact first pose"},
      {"relative", "its landmarks are relative to poses along the path, not to the world"},
      {"fej_ekf", "it is made for directions that no detection shows; a known map has none"},
      {"oc_ekf", "it is made for directions that no detection shows; a known map has none"},
      {"robocentric", "it is made for directions that no detection shows; a known map has none"}};
  const auto* const found = std::ranges::find_if(
      kReasons, [&](const Reason& reason) { return filter.find(reason.filters) != filter.npos; });
  return found == std::end(kReasons) ? "it cannot be started from a known map" : found->text;
}

}  // namespace

bool map_is_known(const Settings& settings) { return settings.text("belief", "map") == "known"; }

bool map_is_exact(const Settings& settings) {
  return map_is_known(settings) && prior_deviations_of(settings, "belief").landmark == 0.0;
}

PriorDeviations prior_deviations_of(const Settings& settings, const std::string& in) {
  if (!settings.has(in, "start_sigma_m")) return {};
  return {.position = settings.number(in, "start_sigma_m"),
          .heading = settings.radians(in, "start_sigma_deg"),
          .landmark = settings.number(in, "map_sigma_m")};
}

void refuse_known_map(const Settings& settings, std::span<const CellSpec> cells,
                      std::span<const FilterKind> filters, std::size_t landmarks) {
  if (!map_is_known(settings)) return refuse_deviations(settings);
  if (landmarks == 0) {
    throw StudyError(settings.place("belief", "map") +
                     ": belief.map = known (this drive has no landmarks.csv): add the surveyed "
                     "landmarks, or set belief.map = estimated");
  }
  for (const CellSpec& cell : cells) {
    if (cell.filter->takes_prior) continue;
    throw StudyError(
        "{}: {} with belief.map = known ({}): use one of {}, or set belief.map = estimated",
        cell.place, cell.filter->name, reason_against_map(cell.filter->name),
        filters_that(filters, &FilterKind::takes_prior));
  }
}

}  // namespace montecarta::experiments
