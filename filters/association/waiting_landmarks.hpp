// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/triangulation.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace montecarta::filters {

/// Landmarks that one detection does not fix, until two do (EQUATIONS 15). A detection that only
/// decides (whether a pair crosses well, on which side of two places) is not used otherwise: what
/// is chosen by its noise must not be estimated from it. `Kept`: what a filter keeps of the
/// detections that place a landmark.
template <class Kept>
class WaitingLandmarks {
 public:
  enum class Stage : std::uint8_t {
    unseen,
    seen,       ///< by a first detection
    crossing,   ///< and a second one would cross it well: the next is used
    ambiguous,  ///< two are kept; of ranges that leaves two places
  };
  struct Waiting {
    std::int32_t identity = 0;
    Stage stage = Stage::unseen;
    double side = 1.0;  ///< of two places
    Kept kept = {};
  };

  explicit WaitingLandmarks(const Sensor& sensor) : of_bearings_(is_of_bearings(sensor)) {}

  bool of_bearings() const { return of_bearings_; }
  void clear() { waiting_.clear(); }
  const Waiting* find(std::int32_t identity) const {
    const auto found = std::ranges::find(waiting_, identity, &Waiting::identity);
    return found == waiting_.end() ? nullptr : &*found;
  }
  /// Unseen where it is new. Valid until the next entry or removal.
  Waiting& entry(std::int32_t identity) {
    const auto found = std::ranges::find(waiting_, identity, &Waiting::identity);
    return found == waiting_.end() ? waiting_.emplace_back(Waiting{.identity = identity}) : *found;
  }
  void remove(Waiting& waiting) {
    std::swap(waiting, waiting_.back());
    waiting_.pop_back();
  }

  /// Whether a detection can take its landmark a step further. `pair` is the detection beside those
  /// that are kept: whether they cross_well() or cross() at all, and the squared_distance() of the
  /// detection from either side.
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
  /// Takes it that step. `keep()` keeps the detection, the first or the second that places the
  /// landmark. Returns whether the landmark is fixed now.
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
  std::vector<Waiting> waiting_;  ///< in no order
};

}  // namespace montecarta::filters
