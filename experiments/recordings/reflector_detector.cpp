// SPDX-License-Identifier: BSD-3-Clause
#include "engine/numbers/angle.hpp"
#include "experiments/recordings/laser.hpp"

#include <cmath>

namespace montecarta::experiments {
namespace {

// [reflectors]
constexpr double kAngleGap = 3.5 * kPi / 360;  ///< [rad] between echoes of one pole: 3 beams
constexpr double kReflectorRangeStep = 1.0;    ///< [m] likewise
constexpr double kPoleRadius = 0.03;           ///< [m] from its surface to its centre

/// What only a reflector sends back.
std::vector<Echo> bright_echoes(LaserSweep ranges, LaserSweep intensities) {
  std::vector<Echo> echoes;
  for (std::size_t beam = 0; beam < ranges.size(); ++beam) {
    const bool bright = intensities[beam] > 0.0 && ranges[beam] < kNoReturn;
    if (bright) echoes.push_back({angle_of(beam), ranges[beam]});
  }
  return echoes;
}

bool are_one_pole(const Echo& a, const Echo& b) {
  return b.angle - a.angle < kAngleGap && std::abs(b.range - a.range) <= kReflectorRangeStep;
}

/// Mean range and mean angle of one pole's echoes.
Detection pole_of(std::span<const Echo> echoes) {
  Echo sum;
  for (const Echo& echo : echoes) {
    sum.angle += echo.angle;
    sum.range += echo.range;
  }
  const auto count = static_cast<double>(echoes.size());
  return {.values = {sum.range / count + kPoleRadius, bearing_of(sum.angle / count)},
          .identity = Detection::kUnidentified};
}

}  // namespace

std::vector<Detection> detect_reflectors(LaserSweep ranges, LaserSweep intensities) {
  const std::vector<Echo> echoes = bright_echoes(ranges, intensities);
  std::vector<Detection> detections;
  for (std::size_t begin = 0, i = 0; i < echoes.size(); ++i) {
    if (i + 1 < echoes.size() && are_one_pole(echoes[i], echoes[i + 1])) continue;
    detections.push_back(pole_of(std::span(echoes).subspan(begin, i + 1 - begin)));
    begin = i + 1;
  }
  return detections;
}

}  // namespace montecarta::experiments
