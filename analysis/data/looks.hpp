// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// study.until of a study whose cells stop when their verdict is known.
inline constexpr const char* kUntilVerdict = "verdict";

/// After how many runs each cell of a study of `runs` runs is judged, where its cells stop by
/// verdict (its resolved text says so); empty where they do not: then the verdict is taken once.
std::vector<std::uint64_t> looks_in(const std::string& study_text, std::uint64_t runs);

}  // namespace montecarta::analysis
