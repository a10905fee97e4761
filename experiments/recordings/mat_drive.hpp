// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/files/mat_file.hpp"
#include "experiments/recordings/drive_log.hpp"
#include "experiments/recordings/laser.hpp"

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace montecarta::experiments {

// Parts of a DriveLog from the variables of a MATLAB file, each checked. Throw StudyError naming
// file, variable and record.

/// One value for each of `count` records. Throws unless the variable has as many.
std::vector<double> series_of(const MatFile& file, const std::string& name, std::size_t count);

std::vector<Odometry> odometry_of(const MatFile& file, const std::vector<double>& times,
                                  const std::string& speed, const std::string& steering);

ReferencePath reference_of(const MatFile& file, const std::string& name, std::vector<double> times,
                           const std::string& east, const std::string& north);

/// A variable of one row for each scan and one column for each beam.
class SweepMatrix {
 public:
  SweepMatrix(const MatFile& file, const std::string& name);
  std::size_t scans() const { return static_cast<std::size_t>(values_->rows()); }
  std::array<double, kLaserBeams> sweep(std::size_t scan) const;

 private:
  const Eigen::MatrixXd* values_;  ///< the file's
};

/// Scans at `times`, each with what `detect` makes of the scan of that index.
std::vector<LoggedScan> scans_of(const MatFile& file, const std::vector<double>& times,
                                 std::size_t sweeps,
                                 const std::function<std::vector<Detection>(std::size_t)>& detect);

/// "FILE: scan N", from 1.
std::string scan_place(const MatFile& file, std::size_t scan);

}  // namespace montecarta::experiments
