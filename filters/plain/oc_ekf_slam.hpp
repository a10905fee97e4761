// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/plain/fej_ekf_slam.hpp"

namespace montecarta::filters::plain {

/// Observability-constrained EKF-SLAM (EQUATIONS 15; Huang, Mourikis and Roumeliotis 2010). It is
/// FEJ-EKF-SLAM at points that follow the estimates as far as the unobservable directions allow.
class OcEkfSlam final : public FejEkfSlam {
 public:
  using FejEkfSlam::FejEkfSlam;

 protected:
  /// Shifts all points by s, which brings them nearest to the estimates (EQUATIONS (15.12)).
  void shift_points() override {
    Vector<2> sum = mean_.head<2>() - n_x_;
    for (std::size_t i = 0; i < n_l_.size(); ++i) sum += mean_.segment<2>(row_of(i)) - n_l_[i];
    const Vector<2> s = sum / static_cast<double>(n_l_.size() + 1);
    n_x_ += s;
    for (Vector<2>& point : n_l_) point += s;
  }
};

}  // namespace montecarta::filters::plain
