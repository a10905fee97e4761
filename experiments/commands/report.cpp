// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/report.hpp"

#include "engine/errors.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/plan_arguments.hpp"
#include "experiments/commands/stored_result.hpp"

#include <filesystem>
#include <iostream>

namespace montecarta {
namespace {

int report(const Arguments& arguments) {
  const auto directory = arguments.text("output");
  if (!directory)
    throw StudyError("report: -o DIR is missing (figures need a place): add e.g. -o report");
  const Parallel parallel = parallel_of(arguments);
  ReportOptions options;
  options.level = arguments.number("level", 1e-9, 1.0 - 1e-9).value_or(options.level);
  options.run = arguments.count("run", 0, UINT32_MAX);
  options.existing = arguments.has("force") ? ExistingReport::replace : ExistingReport::refuse;
  options.parallel = &parallel;
  write_report(open_stored(arguments.operands().front()), *directory, options);
  std::cout << (std::filesystem::path(*directory) / "index.html").string() << "\n";
  return kDone;
}

}  // namespace

Command report_command() {
  return {
      {.name = "report",
       .summary =
           "writes figures (SVG, PDF), tables (CSV, LaTeX) and one self-contained index.html",
       .operands = {{"FILE.h5"}},
       .options = {{"output", "o", {"DIR"}, "where it goes"},
                   {"level", "", {"L"}, "probability inside the NEES bounds; default 0.95"},
                   {"run", "", {"R"}, "whose paths are drawn; default the first complete run"},
                   {"force", "", {}, "replace a report that is there"},
                   {"threads", "", {"N"}, "default: what this process may use"},
                   {"backend", "", {"tbb|openmp|serial"}, "how the work is spread over threads"}},
       .details = {}},
      report};
}

}  // namespace montecarta
