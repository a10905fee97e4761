// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/judgement.hpp"
#include "engine/records/result_file.hpp"
#include "engine/threads/parallel.hpp"

#include <filesystem>
#include <optional>

namespace montecarta::analysis {

/// The behaviour of write_report() if the directory already holds a report.
enum class ExistingReport { refuse, replace };

struct ReportOptions {
  double level = kUsualLevel;    ///< level of NEES bounds and tests
  std::optional<double> within;  ///< margin of consistent ratios; default: that of the study
  /// Number of the run that is drawn and replayed; default: chosen_run().
  std::optional<std::uint64_t> run;
  ExistingReport existing = ExistingReport::refuse;
  const Parallel* parallel = &Parallel::serial();
};

/// Writes index.html (self-contained), summary.md (its tables and first figure), figures/*.svg and
/// *.pdf, data/*.csv (each figure's numbers) and tables/*.csv, *.tex into `directory`, which is
/// made where it is missing. Figures are drawn by gnuplot. Throws StudyError where a report is
/// there already or gnuplot is missing, RunError where a file cannot be written or gnuplot fails.
void write_report(const ResultFile& file, const std::filesystem::path& directory,
                  const ReportOptions& options = {});

}  // namespace montecarta::analysis
