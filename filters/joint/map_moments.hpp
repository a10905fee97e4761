// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstddef>

namespace montecarta::filters {

// Rows of a map's covariance are stored in packs of eight, and those behind the last landmark are
// zero. Of the symmetric matrix are kept, column by column, the pack on the diagonal and all below.

inline constexpr Eigen::Index kPack = 8;

/// Rows that so many landmarks take.
inline Eigen::Index packed(std::size_t n_landmarks) {
  return (2 * static_cast<Eigen::Index>(n_landmarks) + kPack - 1) / kPack * kPack;
}

/// First row of a landmark.
inline Eigen::Index row_of(std::size_t slot) { return 2 * static_cast<Eigen::Index>(slot); }

/// First row of the pack that `row` is in: the first that is kept of this column.
inline Eigen::Index pack_of(Eigen::Index row) { return row / kPack * kPack; }

/// Makes the upper triangle equal to the lower one.
inline void mirror_lower(Eigen::Matrix3d& P) {
  P.triangularView<Eigen::StrictlyUpper>() = P.transpose();
}

/// Likewise in the diagonal's pack, after the two rows from `row` on were written up to the
/// diagonal.
inline void mirror_pack(Eigen::MatrixXd& map, Eigen::Index row) {
  const Eigen::Index first = pack_of(row);
  map.block(first, row, row - first, 2) = map.block(row, first, 2, row - first).transpose();
}

/// Likewise in all packs of so many rows.
inline void mirror_packs(Eigen::MatrixXd& map, Eigen::Index rows) {
  for (Eigen::Index first = 0; first < rows; first += kPack) {
    auto pack = map.block<kPack, kPack>(first, first);
    pack.triangularView<Eigen::StrictlyUpper>() = pack.transpose();
  }
}

/// Covariance of two points, by their first rows.
inline Eigen::Matrix2d covariance_of(const Eigen::MatrixXd& map, Eigen::Index row,
                                     Eigen::Index column) {
  if (row >= column) return map.block<2, 2>(row, column);
  return map.block<2, 2>(column, row).transpose();
}

/// The two columns of a landmark in full.
template <class Columns>
void copy_columns(const Eigen::MatrixXd& map, Eigen::Index row, Eigen::Index rows,
                  Columns& columns) {
  const Eigen::Index first = pack_of(row);
  columns.topRows(first) = map.block(row, 0, 2, first).transpose();
  columns.middleRows(first, rows - first) = map.block(first, row, rows - first, 2);
}

/// Writes them below the diagonal.
template <class Columns>
void write_columns(Eigen::MatrixXd& map, Eigen::Index row, Eigen::Index rows,
                   const Columns& columns) {
  map.block(row, 0, 2, row) = columns.topRows(row).transpose();
  map.block(row, row, rows - row, 2) = columns.middleRows(row, rows - row);
}

/// The moments of a map's points, in packs; rows behind the last point are zero.
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

}  // namespace montecarta::filters
