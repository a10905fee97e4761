// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <string>
#include <string_view>

namespace montecarta::engine {

/// SHA-256 in lower-case hexadecimal, 64 characters, as sha256sum prints it.
std::string sha256(std::string_view text);

}  // namespace montecarta::engine
