// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace montecarta::analysis {

/// A filter is consistent enough where the ratio of its NEES to the expected one lies within
/// [1 / r, r], r this where neither the study nor the user says otherwise.
inline constexpr double kUsualMargin = 1.1;
inline constexpr double kLeastMargin = 1.001, kMostMargin = 100.0;

/// What the study of a result file says (study.within of its resolved text), else kUsualMargin.
/// Throws StudyError where it is no number from kLeastMargin to kMostMargin.
double margin_in(const std::string& study_text);

}  // namespace montecarta::analysis
