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
    controls_of(belief_.vehicle).size() == 2 ? move_by_points<2>(p, control, duration)
                                             : move_by_points<3>(p, control, duration);
  }

  /// Ankishan (15) to (18), and the innovation of the weight (26) as EQUATIONS (8.1), (8.2).
  std::optional<Innovation> update_with(Particle& p, const Landmark& landmark,
                                        const Detection& z) const override {
    if (!parts_.pose) return FastSlam2::update_with(p, landmark, z);
    if (!is_far_enough(p.pose, landmark.mean)) return std::nullopt;
    const Differences<7, 2> whole = observation(p, landmark, factor_of(landmark));
    const Differences<7, 2> image =
        map_uncertainty_ ? whole : observation(p, landmark, Matrix<2>::Zero());
    const Matrix<3> S = tria_in<3>(across_first_with_heading(p.pose, landmark.mean), p.factor);
    const Matrix<2, 3> Ax = image.A.leftCols<3>();
    const Matrix<3, 2> K =
        square_root_gain<3, 2>(S * Ax.transpose(), tria_of<2, 7, 7>(image.A, image.B));
    p.pose += K * difference(z, image.mean);
    p.pose(2) = wrap(p.pose(2));
    keep(p, tria_of<3, 3, 4, 7>(S - K * Ax, K * image.A.rightCols<4>(), K * image.B));
    const Matrix<2> Sy = tria_of<2, 7, 7>(whole.A, whole.B);
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
    const Matrix<2> K = square_root_gain<2, 2>(S * image.A.transpose(), Sy);
    landmark.mean += K * difference(z, image.mean);
    keep(landmark, tria_of<2, 2, 2, 2>(S - K * image.A, K * R_.cwiseSqrt(), K * image.B));
  }

  /// Ankishan (24), (25), as EQUATIONS (8.3).
  Landmark initialised(const Vector<3>& pose, const Detection& z) const override {
    if (!parts_.map) return FastSlam2::initialised(pose, z);
    const auto image = central_differences<2, -1>(vector_of(z), Matrix<2>(R_.cwiseSqrt()), h_,
                                                  PlaceModel{as_pose(pose)});
    Landmark landmark{.mean = image.mean, .covariance = {}};
    keep(landmark, tria_of<2, 2, 2>(image.A, image.B));
    return landmark;
  }

 private:
  /// The observation of a landmark from a known pose.
  struct Observation {
    Matrix<2> S;  ///< root of the covariance of the landmark
    Differences<2, 2> image;
    Matrix<2> Sy;  ///< root of the covariance of the innovation
  };

  /// Points of (pose, noise of C controls, noise of the sensor) through f.
  template <int C>
  void move_by_points(Particle& p, const Control& control, double duration) const {
    const Matrix<C> root = control_noise(belief_, control).cwiseSqrt();
    const auto S = blocks<3, C, 2>(tria_in<3>(heading_first(), p.factor), root, R_.cwiseSqrt());
    const auto image =
        central_differences<3, 2>(stacked<5 + C>(p.pose, Vector<C>(Vector<C>::Zero())), S, h_,
                                  MotionModel<C>{control, duration, belief_.vehicle});
    p.pose = image.mean;
    keep(p, tria_of<3, 5 + C, 5 + C>(image.A, image.B));
  }

  /// Points of (pose, landmark, noise of the sensor) through h.
  Differences<7, 2> observation(const Particle& p, const Landmark& landmark,
                                const Matrix<2>& map_root) const {
    const auto S =
        blocks<3, 2, 2>(tria_in<3>(across_first_with_heading(p.pose, landmark.mean), p.factor),
                        tria_in<2>(across_first(p.pose, landmark.mean), map_root), R_.cwiseSqrt());
    return central_differences<2, 1>(stacked<7>(p.pose, landmark.mean), S, h_, ObservationModel{});
  }

  Observation observation_from(const Vector<3>& pose, const Landmark& landmark) const {
    Observation seen;
    seen.S = tria_in<2>(across_first(pose, landmark.mean), factor_of(landmark));
    seen.image = central_differences<2, 1>(landmark.mean, seen.S, h_, LandmarkModel{as_pose(pose)});
    seen.Sy = tria_of<2, 2, 2, 2>(seen.image.A, seen.image.B, R_.cwiseSqrt());
    return seen;
  }

  /// A landmark of FastSLAM II has no factor of its own.
  Matrix<2> factor_of(const Landmark& landmark) const {
    return parts_.map ? landmark.factor : psd_chol<2>(landmark.covariance);
  }
  template <class Kept, class Factor>
  static void keep(Kept& kept, const Factor& S) {
    kept.factor = S;
    kept.covariance = S * S.transpose();
  }

  SrcdParts parts_;
  double h_;
  bool map_uncertainty_;
};

}  // namespace montecarta::filters::plain
