// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <span>
#include <string>
#include <string_view>

namespace montecarta::engine {

/// Joins texts: "a, b, c".
std::string joined(std::span<const std::string> parts, std::string_view between = ", ");

/// Appends a part to a list that may be empty: "a, b" becomes "a, b, c".
void append_part(std::string& list, std::string_view part, std::string_view between = ", ");

}  // namespace montecarta::engine
