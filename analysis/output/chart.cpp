// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/chart.hpp"

#include <array>

namespace montecarta::analysis {
namespace {

constexpr std::array kColours = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"};

}  // namespace

std::string line_colour(std::size_t i) {
  if (i == kTruthStyle) return "#999999";
  return i == kReferenceStyle ? "black" : kColours[i % kColours.size()];
}

std::size_t line_dashes(std::size_t i) {
  if (i == kTruthStyle) return 1;
  return i == kReferenceStyle ? 2 : 1 + i / kColours.size();
}

}  // namespace montecarta::analysis
