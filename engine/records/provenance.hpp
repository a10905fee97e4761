// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_description.hpp"

#include <string>

namespace montecarta {

/// Of this program, e.g. "0.1.0".
std::string program_version();

/// How this program was built and where and when it runs: version, git, compiler, flags,
/// instruction_set, hdf5; date (UTC), host, system, cpu. What cannot be found out is "unknown". The
/// caller adds its own (command line).
TextPairs collect_provenance();

}  // namespace montecarta
