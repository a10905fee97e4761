// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/fastslam/filter_comparison.hpp"

namespace montecarta {

/// `delayed`, drawing at every so many scans.
inline Variant delayed(const char* every, std::size_t particles = 13,
                       Association association = Association::known) {
  return {.filter = "delayed",
          .association = association,
          .particles = particles,
          .options = {{"draw_every", every}}};
}

/// The same with anchored landmarks.
inline Variant anchored(Variant variant) {
  variant.options["landmarks"] = "anchored";
  return variant;
}

/// A sensor rough enough that landmarks are bent.
inline SmallWorldSettings rough_small_world(std::size_t scans = 40) {
  return {.scans = scans, .noise = {.sigma_range = 0.5, .sigma_bearing = 0.1}};
}

}  // namespace montecarta
