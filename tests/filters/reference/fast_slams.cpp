// SPDX-License-Identifier: BSD-3-Clause
#include "tests/filters/reference/fast_slams.hpp"

#include "tests/filters/reference/de_srcd_fast_slam.hpp"
#include "tests/filters/reference/fast_slam.hpp"
#include "tests/filters/reference/sigma_fast_slams.hpp"

#include <utility>

namespace montecarta::filters::reference {

std::unique_ptr<SlamFilter> make_fast_slam1(const FastSlamSettings& settings) {
  return std::make_unique<FastSlam1>(settings);
}
std::unique_ptr<SlamFilter> make_fast_slam2(const FastSlamSettings& settings, Weight weight) {
  return std::make_unique<FastSlam2>(settings, weight);
}
std::unique_ptr<SlamFilter> make_ufast_slam(const FastSlamSettings& settings, Weight weight,
                                            const Unscented& unscented, bool map_uncertainty) {
  return std::make_unique<UFastSlam>(settings, weight, unscented, map_uncertainty);
}
std::unique_ptr<SlamFilter> make_srcd_fast_slam(const FastSlamSettings& settings, Weight weight,
                                                const SrcdParts& parts) {
  return std::make_unique<SrcdFastSlam>(settings, weight, parts);
}
EvolvedFilter make_de_srcd_fast_slam(const FastSlamSettings& settings, const DeSettings& de) {
  auto filter = std::make_unique<DeSrcdFastSlam>(settings, SrcdParts{}, de);
  const EvolutionRecord* record = &filter->evolution();
  return {std::move(filter), record};
}

}  // namespace montecarta::filters::reference
