// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

}  // namespace montecarta::analysis
