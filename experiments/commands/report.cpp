// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/report.hpp"

#include "analysis/data/study_settings.hpp"
#include "analysis/output/gnuplot.hpp"
#include "engine/errors.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/stored_result.hpp"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>

namespace montecarta::experiments {
namespace {

/// Tries gnuplot before the work: a report takes minutes and needs gnuplot only at the end.
void expect_gnuplot() {
  namespace fs = std::filesystem;
  std::string folder = (fs::temp_directory_path() / "montecarta_XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return;  // drawing the figures will report the error
  const auto remove = [](const std::string* path) { fs::remove_all(*path); };
  const std::unique_ptr<const std::string, decltype(remove)> removed_at_end(&folder, remove);
  std::ofstream(fs::path(folder) / "trial.gp") << "set terminal svg\nset terminal pdfcairo\n";
  run_gnuplot(folder, "trial.gp");
}

int report(const Arguments& arguments) {
  const auto directory = arguments.text("output");
  if (!directory)
    throw StudyError("report: -o DIR is missing (figures need a place): add e.g. -o report");
  const Parallel parallel = parallel_of(arguments);
  ReportOptions options;
  options.level = arguments.number("level", 1e-9, 1.0 - 1e-9).value_or(options.level);
  options.within = arguments.number("within", kLeastMargin, kMostMargin);
  options.run = arguments.count("run", 0, UINT32_MAX);
  options.existing = arguments.has("force") ? ExistingReport::replace : ExistingReport::refuse;
  options.parallel = &parallel;
  expect_gnuplot();
  write_report(open_stored(arguments.operands().front()), *directory, options);
  std::cout << (std::filesystem::path(*directory) / "index.html").string() << "\n";
  return kDone;
}

}  // namespace

Command report_command() {
  return {{.name = "report",
           .summary = "Write figures, tables and one self-contained index.html",
           .operands = {{"FILE.h5"}},
           .options = {{"output", "o", {"DIR"}, "folder to write to"},
                       {"level", "", {"L"}, kLevelMeaning},
                       {"within", "", {"R"}, kWithinMeaning},
                       {"run", "", {"R"}, "run to draw; default: first complete one"},
                       {"force", "", {}, "replace an existing report"},
                       {"threads", "", {"N"}, kThreadsMeaning},
                       {"backend", "", {"tbb|openmp|serial"}, kBackendMeaning}},
           .details = "Figures are SVG and PDF, tables CSV and LaTeX.\n\nexample:\n  montecarta "
                      "report first_study.h5 -o first_study_report\n"},
          report};
}

}  // namespace montecarta::experiments
