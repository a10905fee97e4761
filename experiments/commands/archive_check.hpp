// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/commands/arguments.hpp"

namespace montecarta::experiments {

/// `verify --archive`: computes blocks of archived runs again, prints what differs, and returns the
/// exit code. Operands are entries or folders of entries; without any it is the shipped archive.
int verify_archive(const Arguments& arguments, std::uint64_t seed);

}  // namespace montecarta::experiments
