// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/tables/analysis_file.hpp"
#include "analysis/render/tables/files.hpp"
#include "analysis/render/tables/terminal.hpp"
#include "analysis/study/study_analysis.hpp"
#include "engine/core/judgement.hpp"
#include "engine/errors.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/output_path.hpp"
#include "experiments/commands/stored_result.hpp"

#include <iostream>

namespace montecarta::experiments {
namespace {

/// Throws StudyError before the analysis starts if one of its outputs cannot be written.
void check_outputs(const Arguments& arguments, const ResultFile& file) {
  const auto output = arguments.text("output");
  const auto directory = arguments.text("csv");
  if (output) {
    refuse_input_as_output(*output, arguments.operands());
    require_place_for_result(*output);
  }
  if (arguments.has("force")) return;
  if (output) refuse_existing("", {*output});
  if (!directory) return;
  std::vector<std::string> labels;
  for (const StoredCell& cell : file.cells()) labels.push_back(cell.label);
  refuse_existing(*directory, csv_names(labels));
}

/// Throws StudyError unless all files hold the same study: the tables of different studies below
/// each other could be mistaken for one.
void require_one_study(const std::vector<std::string>& names) {
  if (names.size() == 1) return;
  const std::string first = open_stored(names.front()).study_sha256();
  for (const std::string& name : names) {
    if (open_stored(name).study_sha256() == first) continue;
    throw StudyError(name +
                     ": holds another study (its SHA-256 differs from that of the first file): "
                     "analyze each study by itself");
  }
}

void print(const StudyAnalysis& study, const std::string& name, const Arguments& arguments) {
  const std::size_t width = engine::output_width();
  if (const auto table = arguments.text("table")) {
    print_named(std::cout, study, *table, width);
  } else if (arguments.has("all")) {
    print_all(std::cout, study, width);
  } else {
    print_summary(std::cout, study, width);
    print_where_to_look(name, "");
  }
}

}  // namespace

int analyze_command(const Arguments& arguments) {
  const double level = arguments.number("level", 1e-9, 1.0 - 1e-9).value_or(kUsualLevel);
  const auto within = arguments.number("within", kLeastMargin, kMostMargin);
  const std::vector<std::string>& names = arguments.operands();
  const bool writes = arguments.has("output") || arguments.has("csv");
  if (writes && names.size() > 1) {
    throw StudyError(
        "analyze: -o and --csv take one file (shards are merged first): see montecarta "
        "merge --help");
  }
  require_one_study(names);
  for (const std::string& name : names) {
    const ResultFile file = open_stored(name);
    check_outputs(arguments, file);
    const StudyAnalysis study = analyze(file, level, parallel_of(arguments), within);
    if (names.size() > 1) std::cout << (name == names.front() ? "" : "\n") << name << "\n";
    print(study, name, arguments);
    if (const auto directory = arguments.text("csv")) write_csv(study, *directory);
    if (const auto output = arguments.text("output")) write_analysis_file(study, *output);
  }
  return kDone;
}

}  // namespace montecarta::experiments
