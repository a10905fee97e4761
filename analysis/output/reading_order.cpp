// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/reading_order.hpp"

namespace montecarta::analysis {

const std::vector<Place>& reading_order() {
  static const std::vector<Place> order = {
      {"title", {}, Section::Shown::open},
      {"cards", {}, Section::Shown::open},
      {"drive", {}, Section::Shown::open},
      {"references", {"reference_error"}, Section::Shown::open},
      {"nees", {"anees"}, Section::Shown::open},
      {"replay", {}, Section::Shown::open},
      {"errors", {"rmse", "error_envelopes"}, Section::Shown::open},
      {"verdict"},
      {"failures"},
      {"components"},
      {"paths", {"paths"}},
      {"survival", {"survival"}},
      {"map_errors"},
      {"map_size", {"map_size"}},
      {"joint_nees", {"joint_nees"}},
      {"observability", {"observability"}},
      {"smoother"},
      {"mismatch", {"mismatch"}},
      {"error_anatomy", {"bias"}},
      {"innovations", {"nis", "whiteness"}},
      {"calibration", {"nees_quantiles", "calibration", "ranks"}},
      {"diversity", {"diversity", "ess", "ancestry"}},
      {"association"},
      {"proper_scores"},
      {"comparison"},
      {"families"},
      {"consistency", {"anees_parts"}},
  };
  return order;
}

}  // namespace montecarta::analysis
