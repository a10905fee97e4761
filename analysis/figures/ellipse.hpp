// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

}  // namespace montecarta::analysis
