// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/run_record.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace montecarta::engine {

/// The number of processes that work on a result at a time: one, on OUT.h5.part, or several
/// attempts, each on a file with its own name.
enum class Claim : std::uint8_t { sole, attempt };

/// An open, locked result file and its state.
struct OpenResult {
  PosixFile file;  ///< OUT.h5.part, or OUT.h5 itself if it was complete already
  ResultSlabs slabs;
  std::vector<std::vector<RunStatus>> status;  ///< {cell}{run index} status of each run
  std::vector<bool> truth_stored;        ///< {run index} whether the true path of the run is stored
  std::vector<std::string> notes;        ///< messages for the user
  Existing existing = Existing::refuse;  ///< treatment of an older OUT.h5 when finishing
  Claim claim = Claim::sole;
};

/// Writes numbers to a file that is laid out.
using Fill = std::function<void(const PosixFile&, const ResultSlabs&)>;

/// Writes a result of which all numbers are known to a temporary name, then gives it its name.
/// Returns its size [byte]. Leaves no file under the temporary name if that fails.
std::uint64_t write_at_once(const std::filesystem::path& path, const ResultDescription& description,
                            const Fill& fill, Existing existing);

/// Opens the result of a plan as ResultWriter::create(), resume() and attempt() say.
OpenResult create_result(const std::filesystem::path& path, const StudyPlan& plan,
                         const TextPairs& provenance, Existing existing);
OpenResult resume_result(const std::filesystem::path& path, const StudyPlan& plan,
                         const TextPairs& provenance);
OpenResult open_attempt(const std::filesystem::path& path, const StudyPlan& plan,
                        const TextPairs& provenance);

/// "HOST.PID", which names this process on all machines.
std::string name_of_process();
/// A unique name for the file of one attempt at the result `path`: OUT.h5.part.HOST.PID.TIME.
std::filesystem::path name_of_attempt(const std::filesystem::path& path);
/// Leaves an incomplete attempt to a later one, as OUT.h5.part unless that name is taken.
void rename_finished(OpenResult& attempt, const std::filesystem::path& path);
/// Renames a complete attempt to the final name, unless another one was first, and removes the
/// files of all other attempts.
void complete_attempt(PosixFile& attempt, const std::filesystem::path& path);

}  // namespace montecarta::engine
