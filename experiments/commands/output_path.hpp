// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// Throws StudyError if writing `output` would overwrite one of `inputs` or the unfinished work
/// (.part) beside it, also through a symbolic or hard link. --force does not change this.
void refuse_input_as_output(const std::filesystem::path& output,
                            const std::vector<std::string>& inputs);

/// Throws StudyError if no result may be written to `output`: its name is empty, it is a link to
/// nothing, or it or the unfinished work beside it exists and is not a regular HDF5 file. --force
/// replaces results only, so that it cannot destroy a study, a device or a text.
void require_place_for_result(const std::filesystem::path& output);

/// Throws StudyError with the first of `names` that exists in `folder`.
void refuse_existing(const std::filesystem::path& folder, const std::vector<std::string>& names);

}  // namespace montecarta::experiments
