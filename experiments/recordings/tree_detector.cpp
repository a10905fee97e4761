// SPDX-License-Identifier: BSD-3-Clause
#include "engine/numbers/real.hpp"
#include "experiments/recordings/laser.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::experiments {
namespace {

// [trees] Lengths [m] and angles [rad]. Echoes lie at whole beams, so many differences of angles
// equal a limit but for rounding. Both sides are computed as the published code does, or the yield
// is another one (53,537 trees in place of 52,792).
constexpr double kFarthestEcho = 75.0;
constexpr double kRangeStep = 1.5;                ///< cuts a segment
constexpr double kAngleStep = 10 * kPi / 360;     ///< likewise
constexpr double kClearance = 3.0;                ///< nearer segments are one bush or wall
constexpr std::size_t kNeighbours = 3;            ///< segments that must be clear of one
constexpr double kOcclusionGap = 2 * kPi / 360;   ///< nearer, one hides part of the other
constexpr double kHalfDegree = kPi / 360;         ///< a trunk's edges lie between beams
constexpr double kLongestChord = 1.0;             ///< of a trunk
constexpr double kNearestStart = 1.0;             ///< nearer is the vehicle itself
constexpr double kFirstAngle = 5 * kPi / 306;     ///< a trunk lies wholly after it
constexpr double kLastAngle = kPi - kFirstAngle;  ///< and before this one

/// Neighbouring echoes that may be one surface.
struct Segment {
  Echo start, end;
  double middle = 0.0;  ///< [m] mean range of the two middle echoes
  bool kept = true;
};

/// Step 1.
std::vector<Echo> echoes_of(LaserSweep ranges) {
  std::vector<Echo> echoes;
  echoes.reserve(ranges.size());
  for (std::size_t beam = 0; beam < ranges.size(); ++beam) {
    if (ranges[beam] < kFarthestEcho) echoes.push_back({angle_of(beam), ranges[beam]});
  }
  return echoes;
}

bool is_cut(const Echo& a, const Echo& b) {
  return std::abs(b.range - a.range) > kRangeStep || b.angle - a.angle > kAngleStep;
}

Segment segment_of(std::span<const Echo> echoes) {
  const std::size_t last = echoes.size() - 1;
  return {.start = echoes.front(),
          .end = echoes.back(),
          .middle = (echoes[last / 2].range + echoes[(last + 1) / 2].range) / 2};
}

/// Step 2.
std::vector<Segment> segments_of(std::span<const Echo> echoes) {
  std::vector<Segment> segments;
  for (std::size_t begin = 0, i = 0; i < echoes.size(); ++i) {
    if (i + 1 < echoes.size() && !is_cut(echoes[i], echoes[i + 1])) continue;
    segments.push_back(segment_of(echoes.subspan(begin, i + 1 - begin)));
    begin = i + 1;
  }
  return segments;
}

double distance(const Echo& a, const Echo& b) {
  const double dx = b.range * std::cos(b.angle) - a.range * std::cos(a.angle);
  const double dy = b.range * std::sin(b.angle) - a.range * std::sin(a.angle);
  return length(dx, dy);
}

/// Step 3: a trunk stands alone.
void discard_crowded(std::vector<Segment>& segments) {
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const std::size_t last = std::min(i + kNeighbours, segments.size() - 1);
    for (std::size_t j = i + 1; j <= last; ++j) {
      if (distance(segments[i].end, segments[j].start) >= kClearance) continue;
      segments[i].kept = segments[j].kept = false;
    }
  }
}

/// Step 4: of two segments side by side the farther one is seen in part only. Those of step 3 hide
/// others too.
void discard_occluded(std::vector<Segment>& segments) {
  for (std::size_t i = 0; i + 1 < segments.size(); ++i) {
    Segment& right = segments[i];
    Segment& left = segments[i + 1];
    if (left.start.angle - right.end.angle >= kOcclusionGap) continue;
    (left.start.range > right.end.range ? left : right).kept = false;
  }
}

/// [m] of the trunk that fills the segment and a quarter of a degree on either side.
double diameter(const Segment& segment) {
  return (segment.end.angle + kHalfDegree - segment.start.angle) *
         (segment.start.range + segment.end.range) / 2;
}

/// Steps 5 and 7.
bool is_trunk(const Segment& segment) {
  const auto& [start, end, middle, kept] = segment;
  const bool inside = start.angle > kFirstAngle && end.angle < kLastAngle;
  return kept && distance(start, end) < kLongestChord && start.range > kNearestStart && inside &&
         std::abs(start.range - end.range) < diameter(segment) / 3;
}

/// Step 8.
Detection detection_of(const Segment& trunk) {
  return {.values = {trunk.middle + diameter(trunk) / 2,
                     bearing_of((trunk.start.angle + trunk.end.angle) / 2)},
          .identity = Detection::kUnidentified};
}

}  // namespace

std::vector<Detection> detect_trees(LaserSweep ranges) {
  const std::vector<Echo> echoes = echoes_of(ranges);
  std::vector<Segment> segments = segments_of(echoes);
  if (segments.empty()) return {};
  discard_crowded(segments);
  discard_occluded(segments);
  std::vector<Detection> detections;
  for (const Segment& segment : segments) {
    if (is_trunk(segment)) detections.push_back(detection_of(segment));
  }
  return detections;
}

}  // namespace montecarta::experiments
