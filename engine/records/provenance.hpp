// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_description.hpp"

#include <string>

namespace montecarta::engine {

/// Version of this program, e.g. "0.1.0".
std::string program_version();

/// The widest registers for which the program was compiled, e.g. "AVX-512". Results do not depend
/// on it.
std::string instruction_set();

/// Facts about the build and the machine: version, git, compiler, flags, libm, instruction_set,
/// hdf5; date (UTC), host, system, cpu. Facts that cannot be determined are "unknown". The caller
/// adds the command line.
TextPairs collect_provenance();

}  // namespace montecarta::engine
