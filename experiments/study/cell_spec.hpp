// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/study/settings.hpp"
#include "filters/factory.hpp"

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta::experiments {

/// One filter in one setting, as a study file asks for it.
struct CellSpec {
  std::string label;  ///< unique in the study; letters, digits and _
  const FilterKind* filter = nullptr;
  std::vector<std::pair<std::string, std::string>>
      options;  ///< every one, in the filter's order, one spelling
  std::vector<std::pair<std::string, std::string>> mismatch =
      {};  ///< the factors of mismatch_options() that are not 1
  std::string
      distinction;    ///< what tells it from others of its filter, for legends: "100 particles"
  std::string place;  ///< "file:line"
};

/// What every filter takes besides its own options: factors on the standard deviations that it
/// believes, so that a study can ask what becomes of a filter that is given wrong noise.
std::span<const Parameter> mismatch_options();
/// The factor of that name; 1 where it is not in the list.
double mismatch_of(const CellSpec& cell, std::string_view name);

/// The cells of all `cell = FILTER key=value,... label=NAME` lines: one for every combination of
/// listed values; a value that is a text is no list and stands in quotes where it holds blanks.
/// What a line leaves out has its default, which may be another where `controls_are_measured`.
/// Throws StudyError at unknown filters, options and values, and where two cells are the same.
std::vector<CellSpec> read_cells(std::span<const IniEntry> entries, const std::string& name,
                                 std::span<const FilterKind> filters, bool controls_are_measured);

/// Gives every cell a label made of what distinguishes it, unless it has one.
void label_cells(std::vector<CellSpec>& cells);

/// The line that reads back as this cell: "fastslam2 label=fastslam2_m100 particles=100 ...".
std::string cell_line(const CellSpec& cell);

/// Throws StudyError where a cell's filter does not take the sensor of [belief], where that is
/// mounted elsewhere than the filter can, or where it would have to find out which landmark a
/// detection is of that does not fix one.
void refuse_sensors(const Settings& settings, std::span<const CellSpec> cells);

}  // namespace montecarta::experiments
