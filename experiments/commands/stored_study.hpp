// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_file.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/study/study.hpp"

namespace montecarta::experiments {

/// --data FOLDER, where the drive of a study lies: a result file holds all of a study but what was
/// recorded.
OptionSpec data_option();

/// The study that a result file holds, its recorded drive read from --data or where
/// $MONTECARTA_DATA says. Tells on standard error where this build may round otherwise than the one
/// that made the file. Throws StudyError where the drive is missing or another one.
Study study_in(const ResultFile& file, const Arguments& arguments);

}  // namespace montecarta::experiments
