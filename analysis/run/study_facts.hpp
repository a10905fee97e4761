// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/judgement.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::analysis {

/// The value of `key` in the section [study] of the resolved study of a result file; nullopt if it
/// is not given.
std::optional<std::string> study_setting(const std::string& study_text, std::string_view key);

/// The value of study.within in a resolved study, else kUsualMargin. Throws StudyError if it is no
/// number from kLeastMargin to kMostMargin.
double margin_in(const std::string& study_text);

/// {interim analysis} Numbers of runs in a study of `runs` runs, if its cells stop by verdict; else
/// empty: there is one analysis, after all runs.
std::vector<std::uint64_t> interim_analyses_in(const std::string& study_text, std::uint64_t runs);

}  // namespace montecarta::analysis
