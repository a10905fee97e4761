// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/statistics/nees_power.hpp"
#include "engine/errors.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/text/table.hpp"

#include <cmath>
#include <iostream>

namespace montecarta::experiments {
namespace {

constexpr double kLeastProbability = 1e-9;

NeesTest test_of(const Arguments& arguments) {
  const auto dimension = arguments.count("dim", 1, 1000);
  const auto ratio = arguments.number("ratio", 1e-6, 1e6);
  if (!dimension || !ratio) {
    throw StudyError(
        "plan: --dim D and --ratio R are needed (what error, and how far off its NEES is): add "
        "e.g. --dim 3 --ratio 1.5");
  }
  const auto level = arguments.number("level", kLeastProbability, 1.0 - kLeastProbability);
  return {.dimension = *dimension, .ratio = *ratio, .level = level.value_or(0.95)};
}

TableRow row_of(const std::string& what, const NeesTest& test, double power) {
  const std::uint64_t runs = runs_needed(test, power);
  const Interval band =
      nees_bounds(runs, test.dimension, level_of_one_scan(test.level, test.scans));
  return {what, std::to_string(runs),
          "[" + readable(band.lower, 4) + ", " + readable(band.upper, 4) + "]",
          percent(nees_power(test, runs))};
}

/// For who does not know what a chi-square is.
std::string meaning_of(const NeesTest& test, double power) {
  const double d = static_cast<double>(test.dimension);
  const double off = std::sqrt(test.ratio);
  const std::string way = test.ratio > 1.0
                              ? readable(off) + " times larger than the filter says"
                              : readable(1.0 / off) + " times smaller than the filter says";
  return "NEES is the squared error in units of what the filter expected of it: " + readable(d) +
         " on the average of a consistent filter, here\n" + readable(d * test.ratio) +
         ", which means errors " + way + ". With so many runs the average NEES of such a\n" +
         "filter leaves the band in " + percent(power) +
         " of studies; a consistent filter stays in it in " + level_text(test.level) +
         " of them.\n";
}

std::string about_scans(std::uint64_t scans) {
  return "'any of " + std::to_string(scans) +
         " scans' widens the band so that a consistent filter stays "
         "inside at all of them (Sidak), and counts a\nfilter as found that leaves it at one or "
         "more, if it is that far off at all. It holds for independent scans;\nneighbouring "
         "scans are correlated, so that they count for fewer: the truth lies between 1 and the "
         "number of\nscans, and the two rows are its ends.\n";
}

int plan(const Arguments& arguments) {
  NeesTest test = test_of(arguments);
  const double power =
      arguments.number("power", kLeastProbability, 1.0 - kLeastProbability).value_or(0.9);
  const std::uint64_t scans = arguments.count("scans", 1, 1'000'000'000).value_or(1);
  std::vector<TableRow> rows{{"test", "runs", "band of the average NEES", "power"}};
  rows.push_back(row_of("one scan", test, power));
  test.scans = scans;
  if (scans > 1) rows.push_back(row_of("any of " + std::to_string(scans) + " scans", test, power));
  std::cout << aligned(rows, 0) << "\n" << meaning_of(test, power);
  if (scans > 1) std::cout << about_scans(scans);
  return kDone;
}

}  // namespace

Command plan_command() {
  return {{.name = "plan",
           .summary = "says how many runs it takes to find that a filter's NEES is R times off",
           .operands = {},
           .options =
               {{"dim", "", {"D"}, "components of the error: 3 for a pose, 2 for a position"},
                {"ratio", "", {"R"}, "how many times the NEES is too large, or too small below 1"},
                {"power", "", {"P"}, "probability of finding it; default 0.9"},
                {"level", "", {"L"}, "probability that a consistent filter passes; default 0.95"},
                {"scans", "", {"K"}, "also: one band over K independent scans"}},
           .details = "examples:\n  montecarta plan --dim 3 --ratio 1.5\n  montecarta plan --dim 3 "
                      "--ratio 1.2 --power 0.8 --scans 100\n"},
          plan};
}

}  // namespace montecarta::experiments
