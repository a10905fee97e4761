// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/h5.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/seal.hpp"

#include <filesystem>

namespace montecarta::engine {

/// Reads the description of an open result file. Throws StudyError if it is no montecarta result of
/// a known major version, if a required part cannot be read or is inconsistent
/// (check_description()), or, in a file without a seal, if another program has changed the
/// structure (check_structure()).
ResultDescription read_description(const h5::Handle& file, const std::filesystem::path& path,
                                   Seal seal);
/// Checks the seal of a file that is not open yet, and reads its description like the function
/// above.
ResultDescription read_description(const std::filesystem::path& path);

}  // namespace montecarta::engine
