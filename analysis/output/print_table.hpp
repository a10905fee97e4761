// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/text_table.hpp"

#include <iosfwd>
#include <string>

namespace montecarta::analysis {

/// A table for a terminal: columns below each other.
void print_table(std::ostream& out, const TextTable& table);

/// A sentence broken into lines that a terminal holds.
void print_wrapped(std::ostream& out, const std::string& sentence);

}  // namespace montecarta::analysis
