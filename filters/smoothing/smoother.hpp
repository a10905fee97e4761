// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_kind.hpp"

namespace montecarta::filters {

FilterKind smoother_kind();
FilterKind fixed_lag_smoother_kind();

}  // namespace montecarta::filters
