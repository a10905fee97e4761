// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/chart.hpp"

#include <cstddef>
#include <string>

namespace montecarta::analysis {

/// A chart as gnuplot draws it.
struct GnuplotChart {
  std::string numbers;     ///< data blocks, once for all terminals
  std::string commands;    ///< behind terminal and style
  std::size_t height = 0;  ///< [px]
};

/// `width` [px].
GnuplotChart gnuplot_chart(const Chart& chart, std::size_t width);

}  // namespace montecarta::analysis
