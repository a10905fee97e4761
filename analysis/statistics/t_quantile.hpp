// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace montecarta::analysis {

/// Two-sided quantile of Student's t with n - 1 degrees of freedom, n > 1.
double t_quantile(std::size_t n, double level);

}  // namespace montecarta::analysis
