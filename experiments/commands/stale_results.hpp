// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_description.hpp"
#include "experiments/commands/benchmark_task.hpp"
#include "experiments/study/study.hpp"

/// The results of benchmark tasks that are stored in a folder, some of which are stale: an earlier
/// version of the program that is the filter made them.
namespace montecarta::experiments {

/// The files of the program that is the filter of a study, with their SHA-256; empty for a filter
/// that is no program.
TextPairs program_files_of(const Study& study);

/// Returns whether there is a result of the task and of its program as it is now. This and the
/// functions below throw StudyError if there is one of another study, or if a file of the program
/// is gone.
bool has_result(const BenchmarkWorker& worker, const BenchmarkTask& task);

/// Returns whether no file of the program of a result is stored, so that no change is noticed.
bool is_of_unknown_files(const BenchmarkTask& task);

/// Removes a result that an earlier version of the program made. Other workers remove it too, so
/// the task must be claimed.
void remove_stale_result(const BenchmarkWorker& worker, const BenchmarkTask& task);

/// Removes what an earlier version of the program has stored for a task without an entry, and files
/// of other studies without a complete run.
void remove_stale_work(const BenchmarkWorker& worker, const BenchmarkTask& task);

}  // namespace montecarta::experiments
