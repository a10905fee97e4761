// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/chart.hpp"

#include <string>

namespace montecarta::analysis {

/// A chart as the page's script reads it (page/script/chart.js).
std::string chart_json(const Chart& chart);

}  // namespace montecarta::analysis
