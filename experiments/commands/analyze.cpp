// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study_analysis.hpp"
#include "analysis/tables.hpp"
#include "engine/errors.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/plan_arguments.hpp"
#include "experiments/commands/stored_result.hpp"

#include <filesystem>
#include <iostream>

namespace montecarta {
namespace {

void refuse_to_overwrite(const Arguments& arguments) {
  const auto output = arguments.text("output");
  if (arguments.has("force") || !output || !std::filesystem::exists(*output)) return;
  throw StudyError(
      *output +
      ": is there already (nothing is overwritten unasked): choose another name, or add --force");
}

int analyze_files(const Arguments& arguments) {
  const double level = arguments.number("level", 1e-9, 1.0 - 1e-9).value_or(0.95);
  const bool writes = arguments.has("output") || arguments.has("csv");
  if (writes && arguments.operands().size() > 1) {
    throw StudyError(
        "analyze: -o and --csv take one file (shards are merged first): see montecarta "
        "merge --help");
  }
  refuse_to_overwrite(arguments);
  for (const std::string& name : arguments.operands()) {
    const StudyAnalysis study = analyze(open_stored(name), level, parallel_of(arguments));
    print_tables(std::cout, study);
    if (const auto directory = arguments.text("csv")) write_csv(study, *directory);
    if (const auto output = arguments.text("output")) write_analysis_file(study, *output);
  }
  return kDone;
}

}  // namespace

Command analyze_command() {
  return {
      {.name = "analyze",
       .summary = "says how wrong and how honest each filter was: tables, HDF5 and CSV",
       .operands = {{"FILE.h5", 1, SIZE_MAX}},
       .options = {{"output", "o", {"OUT.h5"}, "write every metric over time as HDF5"},
                   {"csv", "", {"DIR"}, "write tables and series as CSV"},
                   {"level", "", {"L"}, "probability inside the NEES bounds; default 0.95"},
                   {"force", "", {}, "replace OUT.h5"},
                   {"threads", "", {"N"}, "default: what this process may use"},
                   {"backend", "", {"tbb|openmp|serial"}, "how the work is spread over threads"}},
       .details = {}},
      analyze_files};
}

}  // namespace montecarta
