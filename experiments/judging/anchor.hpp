// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/state_rows.hpp"
#include "experiments/judging/truth_path.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The part of the frame of the map that a truth takes from the first estimate, since estimates
/// cannot observe it.
enum class Anchor : std::uint8_t {
  first,  ///< the position
  yaw,    ///< position and heading about the vertical, as visual-inertial odometry needs
  se3     ///< position and rotation
};

/// The anchor of that name: "first", "yaw" or "se3".
Anchor anchor_named(const std::string& name);
std::string name_of(Anchor anchor);
/// What an anchor moves: "position", "position and heading", "position and rotation".
std::string moved_by(Anchor anchor);

/// Moves the truths {row} of a run by one motion of the map, by which the truth of the first
/// estimate that has one gets its position (and heading, or rotation). This estimate has no error
/// then: its truth becomes nullopt. Returns its row; nullopt if no estimate has a truth. Throws
/// StudyError that begins with `path` if the state is no pose.
std::optional<std::size_t> move_to_anchor(Anchor anchor, const StateRows& estimates,
                                          const std::filesystem::path& path,
                                          std::vector<std::optional<TrueState>>& truths);

/// The largest share of the final variance that a component which the anchor moves already has in
/// the row of the anchor. If it is large, the covariance describes more than the error since then.
/// Deviations up to 1e-6 m or rad count as 0.
double share_at_anchor(Anchor anchor, const StateRows& estimates, std::size_t row);

}  // namespace montecarta::experiments
