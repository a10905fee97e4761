// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/posix_file.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/result_writer.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::engine {

/// Whether one process at a time works at a result, under OUT.h5.part, or several attempts may,
/// each under a name of its own.
enum class Claim : std::uint8_t { sole, attempt };

/// A result file at hand, locked, with what it holds.
struct OpenResult {
  PosixFile file;  ///< OUT.h5.part; OUT.h5 itself where there was nothing left to do
  ResultSlabs slabs;
  std::vector<std::vector<RunStatus>> status;          ///< [cell][run index]
  std::vector<bool> truth_stored;                      ///< [run index]
  std::vector<std::string> notes;                      ///< what the user should hear
  PosixFile::Target target = PosixFile::Target::keep;  ///< what finishing does to an older OUT.h5
  Claim claim = Claim::sole;
};

/// Throws RunError where less than `bytes` are free beside `path`.
void expect_room(const std::filesystem::path& path, double bytes);

/// Lays out an empty result at the temporary name `path` and hands it back locked; leaves nothing
/// where that fails.
PosixFile lay_out_new(const std::filesystem::path& path, const ResultDescription& description);

/// Whether two descriptions are of the same study laid out alike (their runs may differ); else what
/// differs, worded "place: problem (why): remedy" for the file `path`, which `b` describes.
std::optional<std::string> difference(const ResultDescription& a, const ResultDescription& b,
                                      const std::filesystem::path& path);

/// Of two builds, worded for the user; empty where they round alike.
std::vector<std::string> build_differences(const TextPairs& a, const TextPairs& b);

/// A result under its final name, of which nothing is missing; throws StudyError where something
/// is.
OpenResult finished_result(const std::filesystem::path& path, const ResultDescription& planned);
/// Unfinished work at hand that will become `path`, damaged runs forgotten.
OpenResult continued_work(const std::filesystem::path& work, const std::filesystem::path& path,
                          const ResultDescription& planned);

/// See ResultWriter::create.
OpenResult create_result(const std::filesystem::path& path, const StudyPlan& plan,
                         const TextPairs& provenance, Existing existing);
/// See ResultWriter::resume.
OpenResult resume_result(const std::filesystem::path& path, const StudyPlan& plan,
                         const TextPairs& provenance);
/// See ResultWriter::attempt.
OpenResult attempt_result(const std::filesystem::path& path, const StudyPlan& plan,
                          const TextPairs& provenance);
/// Leaves an attempt that is not complete to the next one: under the name OUT.h5.part, if no other
/// left one there.
void rename_finished(OpenResult& attempt, const std::filesystem::path& path);
/// Gives a complete attempt the final name, unless another one was first, and removes what all
/// attempts left.
void complete_attempt(OpenResult& attempt, const std::filesystem::path& path);

}  // namespace montecarta::engine
