// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/verdict/verdict.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// {run}{scan, component} Whitened errors; NaN where there is none.
using ErrorsOfRuns = std::vector<std::vector<double>>;

/// Tests the correlation of errors of many components by two numbers instead of one for each pair.
/// The first is the correlation that the odd runs have along the direction in which the errors of
/// the even runs are correlated most; the second exchanges odd and even runs. So no number is
/// chosen by the errors that it is measured from (STATISTICS 5). A member is named by the two
/// components that contribute most to it. Correlations are in units of `ratio`, the size of the
/// squared errors. Empty if there are too few runs with errors in all components.
std::vector<MemberTest> direction_tests(const ErrorsOfRuns& runs, double ratio,
                                        std::span<const std::string> components);

}  // namespace montecarta::analysis
