// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstddef>

namespace montecarta::filters {

// Rows of the covariance of a map are stored in packs of eight, and those after the last landmark
// are zero. Each column of the symmetric matrix is stored from the pack on the diagonal downwards.

inline constexpr Eigen::Index kPack = 8;

/// Number of rows for `n_landmarks` landmarks.
inline Eigen::Index packed(std::size_t n_landmarks) {
  return (2 * static_cast<Eigen::Index>(n_landmarks) + kPack - 1) / kPack * kPack;
}

/// First row of a landmark.
inline Eigen::Index row_of(std::size_t slot) { return 2 * static_cast<Eigen::Index>(slot); }

/// First row of the pack that contains `row`, the first that is stored of this column.
inline Eigen::Index pack_of(Eigen::Index row) { return row / kPack * kPack; }

/// Makes the upper triangle equal to the lower one.
inline void mirror_lower(Eigen::Matrix3d& P) {
  P.triangularView<Eigen::StrictlyUpper>() = P.transpose();
}

/// Mirrors the pack on the diagonal after the two rows from `row` on were written up to the
/// diagonal.
inline void mirror_pack(Eigen::MatrixXd& map, Eigen::Index row) {
  const Eigen::Index first = pack_of(row);
  map.block(first, row, row - first, 2) = map.block(row, first, 2, row - first).transpose();
}

/// Mirrors all packs of the first `rows` rows.
inline void mirror_packs(Eigen::MatrixXd& map, Eigen::Index rows) {
  for (Eigen::Index first = 0; first < rows; first += kPack) {
    auto pack = map.block<kPack, kPack>(first, first);
    pack.triangularView<Eigen::StrictlyUpper>() = pack.transpose();
  }
}

/// Covariance of two points, given by their first rows.
inline Eigen::Matrix2d covariance_of(const Eigen::MatrixXd& map, Eigen::Index row,
                                     Eigen::Index column) {
  if (row >= column) return map.block<2, 2>(row, column);
  return map.block<2, 2>(column, row).transpose();
}

/// Copies the two full columns of a landmark.
template <class Columns>
void copy_columns(const Eigen::MatrixXd& map, Eigen::Index row, Eigen::Index rows,
                  Columns& columns) {
  const Eigen::Index first = pack_of(row);
  columns.topRows(first) = map.block(row, 0, 2, first).transpose();
  columns.middleRows(first, rows - first) = map.block(first, row, rows - first, 2);
}

/// Writes the two columns of a landmark, on and below the diagonal.
template <class Columns>
void write_columns(Eigen::MatrixXd& map, Eigen::Index row, Eigen::Index rows,
                   const Columns& columns) {
  map.block(row, 0, 2, row) = columns.topRows(row).transpose();
  map.block(row, row, rows - row, 2) = columns.middleRows(row, rows - row);
}

/// The moments of the points of a map, in packs; rows after the last point are zero.
struct MapMoments {
  Eigen::VectorXd mean;                            ///< [m] means of the positions
  Eigen::Matrix<double, Eigen::Dynamic, 3> cross;  ///< covariance with (x, y, heading)
  Eigen::MatrixXd covariance;                      ///< lower triangle and the packs on the diagonal

  Eigen::Index room() const { return mean.size(); }

  /// Makes room for at least `rows` rows; new ones are zero.
  void make_room(Eigen::Index rows) {
    if (rows <= room()) return;
    mean.conservativeResizeLike(Eigen::VectorXd::Zero(rows));
    cross.conservativeResizeLike(Eigen::MatrixXd::Zero(rows, 3));
    covariance.conservativeResizeLike(Eigen::MatrixXd::Zero(rows, rows));
  }

  void clear(Eigen::Index rows) {
    mean.head(rows).setZero();
    cross.topRows(rows).setZero();
    covariance.topLeftCorner(rows, rows).setZero();
  }

  /// Copies the first `rows` rows of `other`, for which there must be room.
  void take(const MapMoments& other, Eigen::Index rows) {
    mean.head(rows) = other.mean.head(rows);
    cross.topRows(rows) = other.cross.topRows(rows);
    covariance.topLeftCorner(rows, rows) = other.covariance.topLeftCorner(rows, rows);
  }
};

/// The moments of one point of a map.
struct PointMoments {
  Eigen::Vector2d mean;
  Eigen::Matrix<double, 2, 3> cross;
  Eigen::Matrix2d covariance;
};

}  // namespace montecarta::filters
