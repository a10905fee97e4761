// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

// Facts by which a study is judged: the study file states them, and the analysis reads them.
namespace montecarta::engine {

/// Level of intervals, bands and verdicts unless the user gives another one.
inline constexpr double kUsualLevel = 0.95;

/// Default margin r: a filter is consistent if the ratio of its NEES to the expected one lies in
/// [1/r, r].
inline constexpr double kUsualMargin = 1.1;
/// kUsualMargin in the spelling of a study file.
inline constexpr const char* kUsualMarginText = "1.1";
inline constexpr double kLeastMargin = 1.001, kMostMargin = 100.0;

/// Value of study.until if cells stop when their verdict is known.
inline constexpr const char* kUntilVerdict = "verdict";

}  // namespace montecarta::engine
