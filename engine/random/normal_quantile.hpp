// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

namespace montecarta::engine {

/// The number that a standard normal variable stays below with `probability` in (0, 1).
double normal_quantile(double probability);

}  // namespace montecarta::engine
