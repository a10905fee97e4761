// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_file.hpp"

#include <cstddef>
#include <vector>

namespace montecarta::analysis {

/// An ellipse as gnuplot draws it.
struct Ellipse {
  double x = 0.0;      ///< [m] centre
  double y = 0.0;      ///< [m]
  double major = 0.0;  ///< [m] diameter
  double minor = 0.0;  ///< [m] diameter
  double angle = 0.0;  ///< [deg] of the major axis
};

/// Where a Gaussian lies within two standard deviations along each axis. `xx`, `xy`, `yy` [m^2]; a
/// covariance with a negative eigenvalue has a diameter of NaN, which is not drawn.
Ellipse two_sigma_ellipse(double x, double y, double xx, double xy, double yy);

/// The map of one cell in one run, as far as the file holds it: at every scan, or the final one.
class StoredMap {
 public:
  StoredMap(const ResultFile& file, const StoredCell& cell, std::size_t run);

  std::size_t landmarks() const { return landmarks_; }  ///< rows of a scan; 0: nothing is stored
  std::size_t scans() const { return scans_; }          ///< 1 where only the final map is stored
  bool is_final_only() const { return final_only_; }

  /// Two-sigma ellipses of the landmarks that the filter has at a scan.
  std::vector<Ellipse> at(std::size_t scan) const;

 private:
  std::size_t landmarks_ = 0, scans_ = 0;
  bool final_only_ = false;
  std::vector<double> mean_, covariance_, seen_;
};

}  // namespace montecarta::analysis
