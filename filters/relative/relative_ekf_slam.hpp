// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_kind.hpp"

namespace montecarta::filters {

FilterKind relative_ekf_slam_kind();

}  // namespace montecarta::filters
