// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

namespace montecarta::engine {

/// Default margin r: a filter is consistent if the ratio of its NEES to the expected one lies in
/// [1/r, r].
inline constexpr double kUsualMargin = 1.1;
inline constexpr double kLeastMargin = 1.001, kMostMargin = 100.0;

}  // namespace montecarta::engine
