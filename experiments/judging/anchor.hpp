// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/error_convention.hpp"
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

/// The components that an anchor moves, by index.
std::vector<Eigen::Index> moved_components(Anchor anchor, const StateShape& shape);

/// Moves the truths {row} of a run by one motion of the map, by which the truth of the first
/// estimate that has one gets its position (and heading, or rotation). This estimate has no error
/// then: its truth becomes nullopt. Returns its row; nullopt if no estimate has a truth. Throws
/// StudyError that begins with `path` if the state is no pose.
std::optional<std::size_t> move_to_anchor(Anchor anchor, const StateRows& estimates,
                                          const std::filesystem::path& path,
                                          std::vector<std::optional<TrueState>>& truths);

/// The error of the estimate at an anchor, which the motion of the truth carries into the errors of
/// all later estimates (STATISTICS (19.8)).
class AnchorError {
 public:
  /// `row` is that of the anchor, `convention` that of the covariances of `estimates`, which must
  /// live longer.
  AnchorError(Anchor anchor, ErrorConvention convention, const StateRows& estimates,
              std::size_t row);

  /// Whether no component that the anchor moves has a deviation above 1e-6 m or rad there.
  bool is_known() const { return covariance_.isZero(0.0); }
  /// The covariance {d, d} of the part that it has in the error of `row`, to first order.
  Eigen::MatrixXd covariance_in(std::size_t row) const;

 private:
  Anchor anchor_;
  ErrorConvention convention_;
  const StateRows* estimates_;
  std::size_t row_;
  Eigen::MatrixXd covariance_;  ///< of the pose in the map: position, then rotation
};

}  // namespace montecarta::experiments
