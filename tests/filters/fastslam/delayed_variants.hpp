// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/fastslam/filter_comparison.hpp"

namespace montecarta::filters {

/// `delayed`, drawing at every so many scans.
inline Variant delayed(const char* every, std::size_t particles = 13,
                       Association association = Association::known) {
  return {.filter = "delayed",
          .association = association,
          .particles = particles,
          .options = {{"draw_every", every}}};
}

}  // namespace montecarta::filters
