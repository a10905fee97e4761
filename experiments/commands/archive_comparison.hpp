// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/commands/arguments.hpp"

namespace montecarta::experiments {

/// `compare --archive`: prints each cell of a result beside the archived filters of its world, and
/// compares them run by run. Returns the exit code.
int compare_with_archive(const Arguments& arguments);

}  // namespace montecarta::experiments
