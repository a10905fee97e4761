// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/text_table.hpp"

#include <string>
#include <vector>

namespace montecarta::analysis {

/// Where a section stands, with the figures of its subject.
struct Place {
  std::string section;
  std::vector<std::string> figures = {};
  Section::Shown shown = Section::Shown::folded;  ///< on the page
};

/// From the first section to the last, on the page and on a terminal. Sections without a place come
/// behind them.
const std::vector<Place>& reading_order();

}  // namespace montecarta::analysis
