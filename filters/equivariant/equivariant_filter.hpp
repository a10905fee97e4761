// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_kind.hpp"

namespace montecarta::filters {

FilterKind polar_equivariant_kind();

}  // namespace montecarta::filters
