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

/// Throws StudyError if no result may be written to `output`: the name is empty, it is a link to
/// nothing, or it or the unfinished work beside it is there and is anything but a regular HDF5
/// file.
/// --force replaces results, never a study, a device, a pipe or a letter.
void expect_place_for_result(const std::filesystem::path& output);

/// Throws StudyError naming the first of `names` that is in `folder` already.
void refuse_existing(const std::filesystem::path& folder, const std::vector<std::string>& names);

}  // namespace montecarta::experiments
