// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/judgement.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::analysis {

/// A key of the section [study] in the resolved study of a result file; nullopt if it is not given.
std::optional<std::string> study_setting(const std::string& study_text, std::string_view key);

/// study.within of a resolved study, else kUsualMargin. Throws StudyError if it is no number from
/// kLeastMargin to kMostMargin.
double margin_in(const std::string& study_text);

/// Numbers of runs of the interim analyses in a study of `runs` runs, if its cells stop by verdict;
/// else empty: the verdict is then taken once.
std::vector<std::uint64_t> looks_in(const std::string& study_text, std::uint64_t runs);

}  // namespace montecarta::analysis
