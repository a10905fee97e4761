// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::analysis {

/// What the section [study] of a resolved study, as a result file holds it, says of this key;
/// nullopt where it says nothing.
std::optional<std::string> study_setting(const std::string& study_text, std::string_view key);

/// A filter is consistent enough where the ratio of its NEES to the expected one lies within
/// [1 / r, r], r this where neither the study nor the user says otherwise.
inline constexpr double kUsualMargin = 1.1;
inline constexpr double kLeastMargin = 1.001, kMostMargin = 100.0;

/// What the study of a result file says (study.within of its resolved text), else kUsualMargin.
/// Throws StudyError where it is no number from kLeastMargin to kMostMargin.
double margin_in(const std::string& study_text);

/// study.until of a study whose cells stop when their verdict is known.
inline constexpr const char* kUntilVerdict = "verdict";

/// After how many runs each cell of a study of `runs` runs is judged, where its cells stop by
/// verdict (its resolved text says so); empty where they do not: then the verdict is taken once.
std::vector<std::uint64_t> looks_in(const std::string& study_text, std::uint64_t runs);

}  // namespace montecarta::analysis
