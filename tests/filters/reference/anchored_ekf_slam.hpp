// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/reference/anchored_fast_slam.hpp"
#include "tests/filters/reference/textbook_ekf_slam.hpp"

#include <vector>

namespace montecarta::reference {

/// EKF-SLAM whose landmarks are range and bearing from the mean pose at birth (SPEC 24, last
/// lines), which stays where it was: all that the pose erred by then is theirs.
class AnchoredEkfSlam final : public TextbookEkfSlam {
 public:
  using TextbookEkfSlam::TextbookEkfSlam;

  void start(const Pose& start) override {
    TextbookEkfSlam::start(start);
    anchors_.clear();
  }
  Look look(Eigen::Index row) const override {
    const auto place = placed_at(row);
    const auto at = linearised_sight(pose(), place.point);
    return stacked(at, row, landmark_jacobian(at) * sight_jacobian(place));
  }
  void update_map(Scan scan) override {
    for (const Detection& detection : scan) {
      const Eigen::Index row = row_of(detection.identity);
      Eigen::Vector2d q = mean.segment<2>(row);
      Eigen::Matrix2d P = covariance.block<2, 2>(row, row);
      update_sight(q, P, anchor_of(row), pose(), detection, R());
      mean.segment<2>(row) = q;
      covariance.block<2, 2>(row, row) = P;
    }
  }
  Eigen::Vector2d place(Eigen::Index row) const override { return to_vector(placed_at(row).point); }
  Eigen::Matrix2d place_covariance(Eigen::Index row) const override {
    const Eigen::Matrix2d Gz = sight_jacobian(placed_at(row));
    return Gz * covariance.block<2, 2>(row, row) * Gz.transpose();
  }

 private:
  /// The landmark is where g(x, z) says; q is what the anchor has to see for it to be there.
  Born born(const Detection& detection) override {
    const auto place = linearised_place(pose(), sight_of(detection));
    const auto from_anchor = linearised_sight(pose(), place.point);
    const Eigen::Matrix2d by_place = landmark_jacobian(from_anchor);
    anchors_.push_back(pose());
    return {to_vector(sight_of(detection)), by_place * pose_jacobian(place),
            by_place * sight_jacobian(place)};
  }
  const Pose& anchor_of(Eigen::Index row) const {
    return anchors_[static_cast<std::size_t>((row - 3) / 2)];
  }
  LinearisedPlace<double> placed_at(Eigen::Index row) const {
    return placed(anchor_of(row), mean.segment<2>(row));
  }

  std::vector<Pose> anchors_;  ///< {landmark}
};

}  // namespace montecarta::reference
