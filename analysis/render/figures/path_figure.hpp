// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/run_rows.hpp"
#include "analysis/study/figure.hpp"
#include "engine/records/result_file.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// An ellipse as gnuplot draws it.
struct Ellipse {
  double x = 0.0;      ///< [m] centre
  double y = 0.0;      ///< [m] centre
  double major = 0.0;  ///< [m] diameter
  double minor = 0.0;  ///< [m] diameter
  double angle = 0.0;  ///< [deg] angle of the major axis
};

/// The ellipse of two standard deviations of a Gaussian. `xx`, `xy`, `yy` [m^2] are its covariance;
/// if that has a negative eigenvalue, a diameter is NaN, and the ellipse is not drawn.
Ellipse two_sigma_ellipse(double x, double y, double xx, double xy, double yy);

/// The map of one cell in one run: at every scan if the file holds that, else the final map.
class StoredMap {
 public:
  StoredMap(const ResultFile& file, const StoredCell& cell, std::size_t run);

  /// Number of rows of a scan; 0 if nothing is stored.
  std::size_t landmarks() const { return landmarks_; }
  /// Number of scans; 1 if only the final map is stored.
  std::size_t scans() const { return scans_; }
  bool is_final_only() const { return final_only_; }

  /// Two-sigma ellipse of landmark `l` at a scan; nullopt if the filter does not have it in the
  /// map.
  std::optional<Ellipse> at(std::size_t scan, std::size_t l) const;
  /// Two-sigma ellipses of all landmarks that the filter has in the map.
  std::vector<Ellipse> at(std::size_t scan) const;

 private:
  std::size_t landmarks_ = 0, scans_ = 0;
  bool final_only_ = false;
  std::vector<double> mean_, covariance_, seen_;
};

/// A rectangle of the plane [m].
struct Bounds {
  double left = std::numeric_limits<double>::infinity(), right = -left;
  double low = left, high = -left;

  /// Extends the rectangle to a point; ignores points that are not finite or beyond any map (1e100
  /// m).
  void include(double x, double y);
  bool empty() const { return left > right; }
  /// The rectangle with a margin, and with no side shorter than a quarter of the other.
  Bounds widened() const;
  /// The rectangle extended in every direction by `share` of its longer side.
  Bounds grown(double share) const;
  bool contains(double x, double y) const {
    return x >= left && x <= right && y >= low && y <= high;
  }
};

/// Index in the file of the shown run: `run`, or by default the first run that is complete in every
/// cell, else the first that is complete in most; nullopt if no cell is complete. Throws StudyError
/// if the file does not hold `run`.
std::optional<std::size_t> chosen_run(const ResultFile& file, std::optional<std::uint64_t> run);

/// Returns rows (time, x, y) of at most some hundred fixes of the leading reference; none if there
/// is no reference.
FigureData fix_data(const ResultFile& file, std::size_t run_index);
/// Data files of one cell; files without rows are left out.
struct DrawnPath {
  std::string label;
  std::size_t style = 0;  ///< style index for line_colour()
  FigureData path, poses, map;
};

/// Makes a chart with a map for each cell. All maps show the true landmarks and the fixes of the
/// reference.
Chart path_chart(const std::vector<DrawnPath>& cells, const FigureData& landmarks,
                 const FigureData& fixes, const Bounds& bounds);

/// Makes a figure of the true and the estimated path of one run, with a panel for each cell:
/// landmarks (estimated ones if the map is stored) and ellipses of two standard deviations; for a
/// recorded drive, the fixes of the leading reference instead of the truth. The run is that of
/// chosen_run(). There are no data if no cell is complete. Throws StudyError if the file does not
/// hold `run`.
Figure path_figure(const ResultFile& file, std::optional<std::uint64_t> run);

}  // namespace montecarta::analysis
