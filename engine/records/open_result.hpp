// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/posix_file.hpp"
#include "engine/records/result_slabs.hpp"
#include "engine/records/result_writer.hpp"

#include <filesystem>
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

/// Name of the work in progress of `path`.
std::filesystem::path part_of(const std::filesystem::path& path);

/// Throws RunError where less than `bytes` are free beside `path`.
void expect_room(const std::filesystem::path& path, double bytes);

/// Lays out the work in progress of `path` and hands it back locked. Nothing but it is touched.
PosixFile lay_out_part(const std::filesystem::path& path, const ResultDescription& description,
                       Existing existing);

/// See ResultWriter::create.
OpenResult create_result(const std::filesystem::path& path, const StudyPlan& plan,
                         const Provenance& provenance, Existing existing);
/// See ResultWriter::resume.
OpenResult resume_result(const std::filesystem::path& path, const StudyPlan& plan,
                         const Provenance& provenance);

}  // namespace montecarta
