// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/posix_file.hpp"
#include "engine/records/result_slabs.hpp"
#include "engine/records/result_writer.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace montecarta {

/// A result file at hand, locked, with what it holds.
struct OpenResult {
  PosixFile file;  ///< OUT.h5.part; OUT.h5 itself where there was nothing left to do
  ResultSlabs slabs;
  std::vector<std::vector<RunStatus>> status;          ///< [cell][run index]
  std::vector<bool> truth_stored;                      ///< [run index]
  std::vector<std::string> notes;                      ///< what the user should hear
  PosixFile::Target target = PosixFile::Target::keep;  ///< what finishing does to an older OUT.h5
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

/// See ResultWriter::create.
OpenResult create_result(const std::filesystem::path& path, const StudyPlan& plan,
                         const TextPairs& provenance, Existing existing);
/// See ResultWriter::resume.
OpenResult resume_result(const std::filesystem::path& path, const StudyPlan& plan,
                         const TextPairs& provenance);

}  // namespace montecarta
