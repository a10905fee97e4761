// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_description.hpp"

#include <string>

namespace montecarta::engine {

/// Of this program, e.g. "0.1.0".
std::string program_version();

/// What the bits of a result depend on besides the study and the sources, e.g.
/// "GNU 12.2.0, glibc 2.36, x86_64".
std::string toolchain();

/// How this program was built and where and when it runs: version, git, compiler, flags, libm,
/// instruction_set, hdf5; date (UTC), host, system, cpu. What cannot be found out is "unknown". The
/// caller adds its own (command line).
TextPairs collect_provenance();

}  // namespace montecarta::engine
