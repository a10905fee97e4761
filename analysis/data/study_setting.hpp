// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace montecarta::analysis {

/// What the section [study] of a resolved study, as a result file holds it, says of this key;
/// nullopt where it says nothing.
std::optional<std::string> study_setting(const std::string& study_text, std::string_view key);

}  // namespace montecarta::analysis
