// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/packs.hpp"

#include <Eigen/Core>

namespace montecarta {

/// The moments of a map's points, in packs (packs.hpp); rows behind the last point are zero.
struct MapMoments {
  Eigen::VectorXd mean;                            ///< [m]
  Eigen::Matrix<double, Eigen::Dynamic, 3> cross;  ///< covariance with (x, y, heading)
  Eigen::MatrixXd covariance;                      ///< lower triangle and the diagonal's packs

  Eigen::Index room() const { return mean.size(); }

  /// At least `rows` fit; the new ones are zero.
  void make_room(Eigen::Index rows) {
    const Eigen::Index held = room(), more = rows - held;
    if (more <= 0) return;
    mean.conservativeResize(rows);
    cross.conservativeResize(rows, 3);
    covariance.conservativeResize(rows, rows);
    mean.tail(more).setZero();
    cross.bottomRows(more).setZero();
    covariance.bottomRows(more).setZero();
    covariance.rightCols(more).setZero();
  }

  void clear(Eigen::Index rows) {
    mean.head(rows).setZero();
    cross.topRows(rows).setZero();
    covariance.topLeftCorner(rows, rows).setZero();
  }

  /// Copies so many rows of `other`, for which there is room.
  void take(const MapMoments& other, Eigen::Index rows) {
    mean.head(rows) = other.mean.head(rows);
    cross.topRows(rows) = other.cross.topRows(rows);
    covariance.topLeftCorner(rows, rows) = other.covariance.topLeftCorner(rows, rows);
  }
};

/// One point of a map.
struct PointMoments {
  Eigen::Vector2d mean;
  Eigen::Matrix<double, 2, 3> cross;
  Eigen::Matrix2d covariance;
};

}  // namespace montecarta
