// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace montecarta::analysis {

enum class Align { left, right };

/// A table in words, whatever it is set in.
struct TextTable {
  struct Heading {
    std::string text;
    Align align = Align::right;
  };
  std::vector<Heading> headings;
  std::vector<std::vector<std::string>> rows;
};

/// A table for a terminal: columns below each other.
void print_table(std::ostream& out, const TextTable& table);

/// A sentence broken into lines that a terminal holds.
void print_wrapped(std::ostream& out, const std::string& sentence);

}  // namespace montecarta::analysis
