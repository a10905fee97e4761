// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/verdict/verdict.hpp"

#include <string>

namespace montecarta::analysis {

/// The verdict for a table: "consistent within 1.1", "optimistic: NEES 1.28 to 2.25 times too
/// large", ... Failed runs and unusable samples are part of it.
std::string in_words(const Verdict& verdict);

/// One sentence on the cell `label` that also names time and component.
std::string sentence(const std::string& label, const Verdict& verdict);

}  // namespace montecarta::analysis
