// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/printed.hpp"
#include "experiments/study/cell_spec.hpp"
#include "experiments/study/ini_text.hpp"

#include <span>

namespace montecarta::experiments {

/// What a study says that a paper printed: its lines below [printed]. Throws StudyError with line
/// and remedy where one is not understood, or names a cell or a metric that there is not.
Printed read_printed(std::span<const IniEntry> entries, std::span<const CellSpec> cells);

}  // namespace montecarta::experiments
