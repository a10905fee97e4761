// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/text_table.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "engine/errors.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/text/words.hpp"

#include <array>
#include <cstdio>
#include <iostream>

namespace montecarta::experiments {
namespace {

std::string fixed(double value, int digits) {
  std::array<char, 64> buffer;
  std::snprintf(buffer.data(), buffer.size(), "%.*f", digits, value);
  return buffer.data();
}

double limit(const std::string& text) {
  const auto value = to_number(text);
  if (value && *value >= 0.0) return *value;
  throw StudyError(
      "--match " + text +
      ": no end of an interval (a number from 0 is needed): write e.g. --match 2.19 3.93");
}

void print_matches(const std::vector<std::string>& ends) {
  std::vector<TableRow> rows{{"runs", "dim", "level", "exact interval", "within the digits"}};
  for (const IntervalMatch& match : match_interval(limit(ends[0]), limit(ends[1]))) {
    rows.push_back({std::to_string(match.runs), std::to_string(match.dimension),
                    to_text(match.level),
                    "[" + fixed(match.exact.lower, 4) + ", " + fixed(match.exact.upper, 4) + "]",
                    match.within_digits() ? "yes" : "no"});
  }
  std::cout << aligned(rows, 0);
}

void expect_one_question(const Arguments& arguments) {
  for (const char* option : {"runs", "dim", "level"}) {
    if (!arguments.has("match") || !arguments.has(option)) continue;
    throw StudyError("--match and --" + std::string(option) +
                     ": two questions at once (--match finds runs, dim and level): ask one");
  }
}

}  // namespace

int bounds_command(const Arguments& arguments) {
  expect_one_question(arguments);
  const auto runs = arguments.count("runs", 1, 1'000'000'000);
  const auto dimension = arguments.count("dim", 1, 1000);
  const double level = arguments.number("level", 1e-9, 1.0 - 1e-9).value_or(0.95);
  if (!arguments.has("match") && (!runs || !dimension)) {
    throw StudyError(
        "bounds: --runs N and --dim D are needed (or --match LO HI): add e.g. --runs 30 "
        "--dim 3");
  }
  if (runs && dimension) {
    const Interval interval = nees_bounds(*runs, *dimension, level);
    std::cout << "[" << fixed(interval.lower, 6) << ", " << fixed(interval.upper, 6) << "]\n";
  }
  if (arguments.has("match")) print_matches(arguments.texts("match"));
  return kDone;
}

}  // namespace montecarta::experiments
