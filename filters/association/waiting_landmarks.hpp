// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/triangulation.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace montecarta::filters {

/// Landmarks that one detection does not fix and that wait until two detections do (EQUATIONS 15).
/// A detection that is only used to decide (whether a pair crosses well, or which of two places is
/// right) does not enter the estimate: its noise would then be correlated with the decision. `Kept`
/// is the information that a filter keeps of the detections that place a landmark.
template <class Kept>
class WaitingLandmarks {
 public:
  enum class Stage : std::uint8_t {
    unseen,
    seen,       ///< a first detection is kept
    crossing,   ///< a second detection crossed the first one well: the next one is kept
    ambiguous,  ///< two detections are kept; two ranges leave two places
  };
  struct Waiting {
    std::int32_t identity = 0;
    Stage stage = Stage::unseen;
    double side = 1.0;  ///< 1 or -1: side of the place that was chosen
    Kept kept = {};
  };

  explicit WaitingLandmarks(const Sensor& sensor) : of_bearings_(is_of_bearings(sensor)) {}

  bool of_bearings() const { return of_bearings_; }
  void clear() { waiting_.clear(); }
  const Waiting* find(std::int32_t identity) const {
    const auto found = std::ranges::find(waiting_, identity, &Waiting::identity);
    return found == waiting_.end() ? nullptr : &*found;
  }
  /// The entry of a landmark, `unseen` if it is new. Valid until the next entry() or remove().
  Waiting& entry(std::int32_t identity) {
    const auto found = std::ranges::find(waiting_, identity, &Waiting::identity);
    return found == waiting_.end() ? waiting_.emplace_back(Waiting{.identity = identity}) : *found;
  }
  void remove(Waiting& waiting) {
    std::swap(waiting, waiting_.back());
    waiting_.pop_back();
  }

  /// Returns whether a detection can advance its landmark by one stage. `pair` compares the
  /// detection with those that are kept: cross_well(), cross(), and squared_distance() of the
  /// detection for either side.
  template <class Pair>
  static bool can_advance(Waiting& waiting, const Pair& pair) {
    switch (waiting.stage) {
      case Stage::unseen:
        return true;
      case Stage::seen:
        return pair.cross_well();
      case Stage::crossing:
        return pair.cross();
      case Stage::ambiguous: {
        const auto side = chosen_side(pair.squared_distance(1.0), pair.squared_distance(-1.0));
        waiting.side = side.value_or(1.0);
        return side.has_value();
      }
    }
    return false;
  }
  /// Advances the landmark by one stage. `keep()` keeps the detection if it is the first or the
  /// second that places the landmark. Returns whether the landmark is fixed now.
  template <class Keep>
  bool advance(Waiting& waiting, const Keep& keep) const {
    switch (waiting.stage) {
      case Stage::unseen:
        keep();
        waiting.stage = Stage::seen;
        return false;
      case Stage::seen:
        waiting.stage = Stage::crossing;
        return false;
      case Stage::crossing:
        keep();
        waiting.stage = Stage::ambiguous;
        return of_bearings_;
      case Stage::ambiguous:
        return true;
    }
    return false;
  }

 private:
  bool of_bearings_;
  std::vector<Waiting> waiting_;  ///< waiting landmarks, in no order
};

}  // namespace montecarta::filters
