// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/benchmark/matrix.hpp"

#include <string>

namespace montecarta::experiments {

/// The matrix as a drawing (SVG).
std::string matrix_figure(const Matrix& matrix);

/// A self-contained page: the figure and a table for each world.
std::string matrix_page(const Matrix& matrix);

}  // namespace montecarta::experiments
