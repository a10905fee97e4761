// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/laser.hpp"

#include "engine/errors.hpp"
#include "experiments/text/words.hpp"

namespace montecarta::experiments {

void check_sweep(LaserSweep ranges, const std::string& place) {
  for (std::size_t beam = 0; beam < ranges.size(); ++beam) {
    if (ranges[beam] >= 0.0) continue;
    throw StudyError(place + ": range " + to_text(ranges[beam]) + " of beam " +
                     std::to_string(beam) + " (a range is 0 m or more, 80 m or more where " +
                     "nothing came back): correct it or take the file as published");
  }
}

}  // namespace montecarta::experiments
