// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/study_analysis.hpp"

#include <string>

namespace montecarta::analysis {

/// A sentence on the subject of the study, for a reader who knows nothing about it.
std::string studied_sentence(const StudyAnalysis& study);

/// What a page of Markdown begins with: which cells have which verdict, which are nearest to the
/// reference of a recorded drive and farthest from it, and what was studied. Innovations have more
/// than one answer, and bounds are no estimates: of these it says only what was studied.
std::string first_paragraph(const StudyAnalysis& study);

}  // namespace montecarta::analysis
