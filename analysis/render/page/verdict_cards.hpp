// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/section.hpp"
#include "analysis/study/study_analysis.hpp"

#include <string>

namespace montecarta::analysis {

/// The verdict on each cell in short, with three numbers and the NEES over time; empty without
/// truth.
Section verdict_cards(const StudyAnalysis& study);

}  // namespace montecarta::analysis
