// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// Throws StudyError where writing `output` would destroy one of `inputs`, or the unfinished work
/// (.part) beside it, under whatever name, symbolic or hard link. --force does not help.
void refuse_input_as_output(const std::filesystem::path& output,
                            const std::vector<std::string>& inputs);

/// Throws StudyError where `output`, or the unfinished work beside it, is there but no HDF5 file:
/// --force replaces results, never a study, a world or a letter.
void refuse_to_replace_other_kinds(const std::filesystem::path& output);

/// Throws StudyError naming the first of `names` that is in `folder` already.
void refuse_existing(const std::filesystem::path& folder, const std::vector<std::string>& names);

}  // namespace montecarta::experiments
