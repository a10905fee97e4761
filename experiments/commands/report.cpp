// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/report.hpp"

#include "analysis/render/figures/gnuplot.hpp"
#include "engine/core/judgement.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/output_path.hpp"
#include "experiments/commands/stored_result.hpp"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>

namespace montecarta::experiments {
namespace {

/// Tries gnuplot before the work: a report takes minutes and needs gnuplot only at the end.
void require_gnuplot() {
  namespace fs = std::filesystem;
  std::string folder = (fs::temp_directory_path() / "montecarta_XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return;  // drawing the figures will report the error
  const auto remove = [](const std::string* path) { fs::remove_all(*path); };
  const std::unique_ptr<const std::string, decltype(remove)> removed_at_end(&folder, remove);
  std::ofstream(fs::path(folder) / "trial.gp") << "set terminal svg\nset terminal pdfcairo\n";
  run_gnuplot(folder, {"trial.gp"});
}

}  // namespace

int report_command(const Arguments& arguments) {
  const std::filesystem::path directory = arguments.text("output").value();
  const Parallel parallel = parallel_of(arguments);
  ReportOptions options;
  options.level = arguments.number("level", 1e-9, 1.0 - 1e-9).value_or(options.level);
  options.within = arguments.number("within", kLeastMargin, kMostMargin);
  options.run = arguments.count("run", 0, UINT32_MAX);
  options.parallel = &parallel;
  if (!arguments.has("force")) refuse_existing(directory, report_names());
  require_gnuplot();
  write_report(open_stored(arguments.operands().front()), directory, options);
  std::cout << (directory / "index.html").string() << "\n";
  return kDone;
}

}  // namespace montecarta::experiments
