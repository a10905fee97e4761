// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/text_table.hpp"
#include "engine/records/result_file.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/study/study.hpp"

#include <string>

namespace montecarta::experiments {

/// Opens FILE.h5, or FILE.h5.part where only unfinished work is there (and says so on standard
/// error).
ResultFile open_stored(const std::string& name);

/// Says on standard output where the page of a result file is (empty: how to draw it), and how to
/// see more of the file.
void print_where_to_look(const std::string& name, const std::string& page);

/// How many runs of a cell are in which state.
struct StatusCounts {
  std::size_t complete = 0;
  std::size_t failed = 0;
  std::size_t missing = 0;
  std::size_t spared = 0;
};
StatusCounts count_status(const std::vector<RunStatus>& status);

/// A table whose last column is of spared runs, without it where no cell spared any: most studies
/// make all.
std::vector<TableRow> without_idle_spared(std::vector<TableRow> rows);

/// --data FOLDER, where the drive of a study lies: a result file holds all of a study but what was
/// recorded.
OptionSpec data_option();

/// The study that a result file holds, its recorded drive read from --data or where
/// $MONTECARTA_DATA says. Tells on standard error where this build may round otherwise than the one
/// that made the file. Throws StudyError where the drive is missing or another one.
Study study_in(const ResultFile& file, const Arguments& arguments);

}  // namespace montecarta::experiments
