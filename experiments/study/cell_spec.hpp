// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/study/settings.hpp"
#include "filters/setup/filter_kind.hpp"

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta::experiments {

/// One filter in one setting, as a study file defines it.
struct CellSpec {
  std::string label;  ///< label, unique in the study, of letters, digits and _
  const FilterKind* filter = nullptr;
  /// All options of the filter, in its order and in canonical spelling, then the factors of
  /// mismatch_options() that are not 1.
  std::vector<std::pair<std::string, std::string>> options;
  std::string distinction;  ///< difference from other cells of its filter: "100 particles"
  std::string place;        ///< place in the study file: "file:line"
};

/// Options that every filter has besides its own: factors on the standard deviations that it
/// assumes, for studies of filters with wrong noise parameters.
std::span<const Parameter> mismatch_options();
/// The factor `name` of the cell; 1 if it is not among its options.
double mismatch_of(const CellSpec& cell, std::string_view name);

/// The cells of all `cell = FILTER key=value,... label=NAME` lines: one for every combination of
/// listed values. A value that is a text is not split at commas, and stands in quotes if it
/// contains blanks. Omitted options have their defaults, which may differ if
/// `controls_are_measured`. Throws StudyError for unknown filters, options and values, and for two
/// cells that are the same.
std::vector<CellSpec> read_cells(std::span<const IniEntry> entries, const std::string& name,
                                 std::span<const FilterKind> filters, bool controls_are_measured);

/// Throws StudyError if a key outside of [cells] is none of its section, but an option of one of
/// `filters`.
void refuse_options_outside_cells(std::span<const IniEntry> entries,
                                  std::span<const FilterKind> filters);

/// The line that reads back as this cell: "fastslam2 label=fastslam2_m100 particles=100 ...".
std::string cell_line(const CellSpec& cell);

/// Names of the filters that take something, e.g. &FilterKind::takes_prior, without the plain ones,
/// for remedies.
std::string filters_that(std::span<const FilterKind> filters, bool FilterKind::*takes);

/// Throws StudyError if the filter of a cell does not accept the sensor of [belief] or its
/// mounting, or must associate detections that do not determine the position of a landmark. The
/// error suggests one of `filters`.
void refuse_sensors(const Settings& settings, std::span<const CellSpec> cells,
                    std::span<const FilterKind> filters);

}  // namespace montecarta::experiments
