// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/plain/fastslam2.hpp"
#include "filters/plain/sigma_points.hpp"
#include "filters/plain/square_roots.hpp"

namespace montecarta::filters::plain {

/// The Gaussians that use central differences; the others are those of FastSLAM II (EQUATIONS 8).
struct SrcdParts {
  bool pose = true;
  bool map = true;
};

/// SRCD-FastSLAM (EQUATIONS 8; Ankishan et al. 2016) as printed and corrected. Poses and landmarks
/// keep square roots from scan to scan; their covariances are formed to draw a pose, to associate,
/// for the weight `ratio` and for reports.
class Srcd : public FastSlam2 {
 public:
  explicit Srcd(const FilterSetup& setup, const SrcdParts& parts)
      : Srcd(setup, parts, setup.options.choice("weights")) {}

 protected:
  Srcd(const FilterSetup& setup, const SrcdParts& parts, const std::string& weights)
      : FastSlam2(setup, weights),
        parts_(parts),
        h_(setup.options.number("interval")),
        map_uncertainty_(!parts.pose || setup.options.choice("map_uncertainty") == "on") {}

  /// Ankishan (9) to (13).
  void move_gaussian(Particle& p, const Control& control, double duration) const override {
    if (!parts_.pose) return FastSlam2::move_gaussian(p, control, duration);
    const SmallMatrix S = blocks({tria_in(heading_first(), p.factor),
                                  control_noise(belief_, control).cwiseSqrt(), R_.cwiseSqrt()});
    const Differences image = central_differences(stacked(p.pose, {}, S.rows()), S, h_,
                                                  motion_model(control, duration, belief_.vehicle));
    SmallMatrix root = tria_of({image.A, image.B});
    if (!belief_.control.increment.is_none())
      root = tria_of({root, increment_root(belief_, p.pose(2), control, duration)});
    p.pose = image.mean;
    keep(p, root);
  }

  /// Ankishan (15) to (18), and the innovation of the weight (26) as EQUATIONS (8.1), (8.2).
  std::optional<Innovation> update_with(Particle& p, const Landmark& landmark,
                                        const Detection& z) const override {
    if (!parts_.pose) return FastSlam2::update_with(p, landmark, z);
    if (!is_far_enough(p.pose, landmark.mean)) return std::nullopt;
    const Differences whole = observation(p, landmark, factor_of(landmark));
    const Differences image =
        map_uncertainty_ ? whole : observation(p, landmark, Matrix<2>::Zero());
    const Matrix<3> S = tria_in(across_first_with_heading(p.pose, landmark.mean), p.factor);
    const SmallMatrix Ax = image.A.leftCols(3);
    const Matrix<3, 2> K = square_root_gain(S * Ax.transpose(), tria_of({image.A, image.B}));
    p.pose += K * difference(z, image.mean);
    p.pose(2) = wrap(p.pose(2));
    keep(p, tria_of({S - K * Ax, K * image.A.rightCols(4), K * image.B}));
    const Matrix<2> Sy = tria_of({whole.A, whole.B});
    return Innovation{difference(z, whole.mean), Sy * Sy.transpose()};
  }

  std::optional<Innovation> innovation(const Vector<3>& pose, const Landmark& landmark,
                                       const Detection& z) const override {
    if (!parts_.map) return FastSlam2::innovation(pose, landmark, z);
    if (!is_far_enough(pose, landmark.mean)) return std::nullopt;
    const Observation seen = observation_from(pose, landmark);
    return Innovation{difference(z, seen.image.mean), seen.Sy * seen.Sy.transpose()};
  }

  /// Ankishan (20) to (23), as EQUATIONS (3.9).
  void update_map(const Vector<3>& pose, Landmark& landmark, const Detection& z) const override {
    if (!parts_.map) return FastSlam2::update_map(pose, landmark, z);
    if (!is_far_enough(pose, landmark.mean)) return;
    const auto& [S, image, Sy] = observation_from(pose, landmark);
    const Matrix<2> K = square_root_gain(S * image.A.transpose(), Sy);
    landmark.mean += K * difference(z, image.mean);
    keep(landmark, tria_of({S - K * image.A, K * R_.cwiseSqrt(), K * image.B}));
  }

  /// Ankishan (24), (25), as EQUATIONS (8.3).
  Landmark initialised(const Vector<3>& pose, const Detection& z) const override {
    if (!parts_.map) return FastSlam2::initialised(pose, z);
    const Differences image =
        central_differences(vector_of(z), R_.cwiseSqrt(), h_, place_model(as_pose(pose)));
    Landmark landmark{.mean = image.mean, .covariance = {}};
    keep(landmark, tria_of({image.A, image.B}));
    return landmark;
  }

 private:
  /// The observation of a landmark from a known pose.
  struct Observation {
    Matrix<2> S;  ///< root of the covariance of the landmark
    Differences image;
    Matrix<2> Sy;  ///< root of the covariance of the innovation
  };

  /// Points of (pose, landmark, noise of the sensor) through h.
  Differences observation(const Particle& p, const Landmark& landmark,
                          const Matrix<2>& map_root) const {
    const SmallMatrix S =
        blocks({tria_in(across_first_with_heading(p.pose, landmark.mean), p.factor),
                tria_in(across_first(p.pose, landmark.mean), map_root), R_.cwiseSqrt()});
    return central_differences(stacked(p.pose, landmark.mean, 7), S, h_, observation_model());
  }

  Observation observation_from(const Vector<3>& pose, const Landmark& landmark) const {
    Observation seen;
    seen.S = tria_in(across_first(pose, landmark.mean), factor_of(landmark));
    seen.image = central_differences(landmark.mean, seen.S, h_, landmark_model(as_pose(pose)));
    seen.Sy = tria_of({seen.image.A, seen.image.B, R_.cwiseSqrt()});
    return seen;
  }

  /// A landmark of FastSLAM II has no factor of its own.
  Matrix<2> factor_of(const Landmark& landmark) const {
    if (parts_.map) return landmark.factor;
    return psd_chol(landmark.covariance);
  }
  template <class Kept>
  static void keep(Kept& kept, const SmallMatrix& S) {
    kept.factor = S;
    kept.covariance = S * S.transpose();
  }

  SrcdParts parts_;
  double h_;
  bool map_uncertainty_;
};

}  // namespace montecarta::filters::plain
