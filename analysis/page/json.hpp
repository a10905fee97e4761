// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/chart.hpp"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Members stand in the order in which they are added.
using Json = nlohmann::ordered_json;

/// A number rounded to `digits` significant ones: nobody sees more in a drawing. NaN becomes null,
/// and what is infinite the text "+inf" or "-inf", since JSON has neither.
Json rounded(double value, int digits = 5);
/// An array of such numbers.
Json rounded(const std::vector<double>& values, int digits = 5);

/// Compact text that may stand in a page's <script>.
std::string script_text(const Json& json);

/// A chart as the page's script reads it (page/script/chart.js).
std::string chart_json(const Chart& chart);

}  // namespace montecarta::analysis
