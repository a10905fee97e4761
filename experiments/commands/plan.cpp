// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/text_table.hpp"
#include "analysis/verdict/nees_plan.hpp"
#include "engine/core/judgement.hpp"
#include "engine/formatted.hpp"
#include "engine/text/number_text.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/commands/commands.hpp"

#include <cmath>
#include <iostream>

namespace montecarta::experiments {
namespace {

constexpr double kLeastProbability = 1e-9;

struct Question {
  double ratio = 1.5;
  double within = kUsualMargin;
  double power = 0.9;
};

TableRow row_of(const std::string& what, const NeesTest& test, const Question& question) {
  const NeesPlan plan(test);
  return {what, std::to_string(plan.runs_to_find(question.ratio, question.power)),
          std::to_string(plan.runs_to_show(question.within, question.power))};
}

/// Explains the table to a reader who does not know the chi-square distribution.
std::string meaning_of(const NeesTest& test, const Question& question) {
  const double d = static_cast<double>(test.dimension);
  const double off = std::sqrt(question.ratio);
  const std::string way = question.ratio > 1.0
                              ? readable(off) + " times larger than the filter estimates"
                              : readable(1.0 / off) + " times smaller than the filter estimates";
  const std::string power = percent(question.power), margin = readable(question.within);
  return formatted(
      "NEES is the squared error in units of its covariance. Its mean is {} for a consistent "
      "filter and {} for the filter in question, whose errors are {}.\ndetect: the filter is "
      "called {} in at least {} of studies, unless the ratio is within the margin.\nshow: a "
      "consistent filter is called consistent within {} in at least {} of studies, in every "
      "component and every eighth of the drive, without bias and correlation.\n",
      readable(d), readable(d * question.ratio), way,
      question.ratio > 1.0 ? "optimistic" : "conservative", power, margin, power);
}

std::string about_scans(std::uint64_t scans) {
  return formatted(
      "Neighbouring scans are correlated, so that a run of {} scans counts for fewer independent "
      "ones. The numbers of runs are between the two rows.\n",
      scans);
}

}  // namespace

int plan_command(const Arguments& arguments) {
  const double ratio = arguments.number("ratio", 1e-6, 1e6).value();
  const auto probability = [&](const char* option, double usual) {
    return arguments.number(option, kLeastProbability, 1.0 - kLeastProbability).value_or(usual);
  };
  NeesTest test{.dimension = arguments.count("dim", 1, 1000).value(),
                .level = probability("level", kUsualLevel)};
  const Question question{
      .ratio = ratio,
      .within = arguments.number("within", kLeastMargin, kMostMargin).value_or(kUsualMargin),
      .power = probability("power", 0.9)};
  const std::uint64_t scans = arguments.count("scans", 1, kMostPlannedScans).value_or(1);
  std::vector<TableRow> rows{{"NEES within a run", "runs: detect " + readable(ratio),
                              "show within " + readable(question.within)}};
  rows.push_back(row_of("constant", test, question));
  test.scans = scans;
  if (scans > 1)
    rows.push_back(row_of(std::to_string(scans) + " independent scans", test, question));
  std::cout << aligned(rows, 0) << "\n" << wrapped(meaning_of(test, question), output_width());
  if (scans > 1) std::cout << wrapped(about_scans(scans), output_width());
  return kDone;
}

}  // namespace montecarta::experiments
