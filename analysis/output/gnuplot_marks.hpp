// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/chart.hpp"

#include <cstddef>
#include <string>

namespace montecarta::analysis {

/// How a panel's bands, curves and marks are plotted.
struct PanelPlots {
  std::string numbers;   ///< data blocks
  std::string commands;  ///< behind "plot"
};

PanelPlots panel_plots(const Chart& chart, std::size_t panel);

/// How gnuplot draws each, behind "with": for plots and legends.
std::string band_style();
std::string curve_style(std::size_t style);
std::string mark_style(const ChartMarks& marks);

}  // namespace montecarta::analysis
