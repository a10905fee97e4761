// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/plain/fastslam2.hpp"
#include "filters/plain/sigma_points.hpp"

namespace montecarta::filters::plain {

/// U-FastSLAM (EQUATIONS 7; Kim et al. 2008): FastSLAM II with the unscented transform at every
/// stage. It replaces the Gaussians and leaves the weight as it is: FastSlam2::refine() sums the
/// densities of the innovations that update_with() returns. Motion has points of pose, controls and
/// sensor noise, an observation has points of pose, landmark and sensor noise: seven dimensions for
/// a car, as in the paper. Landmarks have five points of two dimensions.
class UFastSlam : public FastSlam2 {
 public:
  explicit UFastSlam(const FilterSetup& setup)
      : FastSlam2(setup),
        landmark_{setup.options.number("alpha"), setup.options.number("beta"),
                  setup.options.number("kappa")},
        augmented_(landmark_),
        map_uncertainty_(setup.options.choice("map_uncertainty") == "on") {
    // 7 + (kappa - 2) = 5 + kappa: the points are as far as those of five dimensions (EQUATIONS 7).
    augmented_.kappa -= 2.0;
  }

 protected:
  void move_gaussian(Particle& p, const Control& control, double duration) const override {
    controls_of(belief_.vehicle).size() == 2 ? move_by_points<2>(p, control, duration)
                                             : move_by_points<3>(p, control, duration);
  }

  /// Kim (8) to (12). The weight always includes the covariance of the landmark (EQUATIONS (7.1)).
  std::optional<Innovation> update_with(Particle& p, const Landmark& landmark,
                                        const Detection& z) const override {
    if (!is_far_enough(p.pose, landmark.mean)) return std::nullopt;
    const Image<7, 2> whole = observation(p, landmark, landmark.covariance);
    const Image<7, 2> image =
        map_uncertainty_ ? whole : observation(p, landmark, Matrix<2>::Zero());
    const Matrix<3, 2> K = gain<3, 2>(image.cross.topRows<3>(), image.covariance);
    p.pose += K * difference(z, image.mean);
    p.pose(2) = wrap(p.pose(2));
    p.covariance -= (K * image.covariance * K.transpose()).eval();
    return Innovation{difference(z, whole.mean), whole.covariance};
  }

  std::optional<Innovation> innovation(const Vector<3>& pose, const Landmark& landmark,
                                       const Detection& z) const override {
    if (!is_far_enough(pose, landmark.mean)) return std::nullopt;
    const Image<2, 2> image = observation_from(pose, landmark);
    return Innovation{difference(z, image.mean), image.covariance};
  }

  /// The update (3.2) of EQUATIONS.
  void update_map(const Vector<3>& pose, Landmark& landmark, const Detection& z) const override {
    if (!is_far_enough(pose, landmark.mean)) return;
    const Image<2, 2> image = observation_from(pose, landmark);
    const Matrix<2> K = gain<2, 2>(image.cross, image.covariance);
    landmark.mean += K * difference(z, image.mean);
    landmark.covariance -= (K * image.covariance * K.transpose()).eval();
  }

  Landmark initialised(const Vector<3>& pose, const Detection& z) const override {
    const auto image = unscented<2, -1>(vector_of(z), Matrix<2>(R_.cwiseSqrt()), landmark_,
                                        PlaceModel{as_pose(pose)});
    return {.mean = image.mean, .covariance = image.covariance};
  }

 private:
  /// Points of (pose, noise of C controls, noise of the sensor) through f.
  template <int C>
  void move_by_points(Particle& p, const Control& control, double duration) const {
    const Matrix<C> root = control_noise(belief_, control).cwiseSqrt();
    const auto S = blocks<3, C, 2>(chol_in<3>(heading_first(), p.covariance), root, R_.cwiseSqrt());
    const auto image =
        unscented<3, 2>(stacked<5 + C>(p.pose, Vector<C>(Vector<C>::Zero())), S, augmented_,
                        MotionModel<C>{control, duration, belief_.vehicle});
    p.pose = image.mean;
    p.covariance = image.covariance;
  }

  /// Points of (pose, landmark, noise of the sensor) through h.
  Image<7, 2> observation(const Particle& p, const Landmark& landmark,
                          const Matrix<2>& map_covariance) const {
    const auto S = blocks<3, 2, 2>(
        chol_in<3>(across_first_with_heading(p.pose, landmark.mean), p.covariance),
        chol_in<2>(across_first(p.pose, landmark.mean), map_covariance), R_.cwiseSqrt());
    return unscented<2, 1>(stacked<7>(p.pose, landmark.mean), S, augmented_, ObservationModel{});
  }

  /// Points of the landmark through h from a known pose, plus R.
  Image<2, 2> observation_from(const Vector<3>& pose, const Landmark& landmark) const {
    const Matrix<2> S = chol_in<2>(across_first(pose, landmark.mean), landmark.covariance);
    auto image = unscented<2, 1>(landmark.mean, S, landmark_, LandmarkModel{as_pose(pose)});
    image.covariance += R_;
    return image;
  }

  Unscented landmark_, augmented_;
  bool map_uncertainty_;
};

}  // namespace montecarta::filters::plain
