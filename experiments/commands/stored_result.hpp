// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/text_table.hpp"
#include "engine/records/result_file.hpp"
#include "engine/runs/progress.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/study/study.hpp"

#include <string>

namespace montecarta::experiments {

/// Opens FILE.h5, or FILE.h5.part if only unfinished work exists, with a note on standard error.
ResultFile open_stored(const std::string& name);

/// Prints the verdict of a result. If the file is so large that its analysis takes too long, prints
/// the command that does it, and returns false.
bool print_verdict(const std::filesystem::path& result, const Parallel& parallel);

/// Prints where the report of a result file is and how to see more of the file. If `page` is empty,
/// prints how to draw the report.
void print_where_to_look(const std::string& name, const std::string& page);

/// Counts the runs of a cell in each state.
RunCounts count_status(const std::vector<RunStatus>& status);
/// Counts the runs of a cell in each state, whether the file has them as rows or in sums.
RunCounts count_status(const ResultFile& file, const StoredCell& cell);

/// Removes the last column of a table, which counts runs that are not needed, if no cell has any.
std::vector<TableRow> without_idle_not_needed(std::vector<TableRow> rows);

/// The study that a result file holds, with its recorded drive read from --data or
/// $MONTECARTA_DATA. Warns on standard error if this build may round differently from the one that
/// made the file. Throws StudyError if the drive is missing or is another one.
Study study_in(const ResultFile& file, const Arguments& arguments);

}  // namespace montecarta::experiments
