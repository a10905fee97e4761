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
    const SmallMatrix S = blocks({chol_in(heading_first(), p.covariance),
                                  control_noise(belief_, control).cwiseSqrt(), R_.cwiseSqrt()});
    const Image image = unscented(stacked(p.pose, {}, S.rows()), S, augmented_,
                                  motion_model(control, duration, belief_.vehicle));
    p.covariance = image.covariance + increment_covariance(belief_, p.pose(2), control, duration);
    p.pose = image.mean;
  }

  /// Kim (8) to (12). The weight always includes the covariance of the landmark (EQUATIONS (7.1)).
  std::optional<Innovation> update_with(Particle& p, const Landmark& landmark,
                                        const Detection& z) const override {
    if (!is_far_enough(p.pose, landmark.mean)) return std::nullopt;
    const Image whole = observation(p, landmark, landmark.covariance);
    const Image image = map_uncertainty_ ? whole : observation(p, landmark, Matrix<2>::Zero());
    const Matrix<3, 2> K = gain<3, 2>(image.cross.topRows<3>(), image.covariance);
    p.pose += K * difference(z, image.mean);
    p.pose(2) = wrap(p.pose(2));
    p.covariance -= (K * image.covariance * K.transpose()).eval();
    return Innovation{difference(z, whole.mean), whole.covariance};
  }

  std::optional<Innovation> innovation(const Vector<3>& pose, const Landmark& landmark,
                                       const Detection& z) const override {
    if (!is_far_enough(pose, landmark.mean)) return std::nullopt;
    const Image image = observation_from(pose, landmark);
    return Innovation{difference(z, image.mean), image.covariance};
  }

  /// The update (3.2) of EQUATIONS.
  void update_map(const Vector<3>& pose, Landmark& landmark, const Detection& z) const override {
    if (!is_far_enough(pose, landmark.mean)) return;
    const Image image = observation_from(pose, landmark);
    const Matrix<2> K = gain<2, 2>(image.cross, image.covariance);
    landmark.mean += K * difference(z, image.mean);
    landmark.covariance -= (K * image.covariance * K.transpose()).eval();
  }

  Landmark initialised(const Vector<3>& pose, const Detection& z) const override {
    const Image image =
        unscented(vector_of(z), R_.cwiseSqrt(), landmark_, place_model(as_pose(pose)));
    return {.mean = image.mean, .covariance = image.covariance};
  }

 private:
  /// Points of (pose, landmark, noise of the sensor) through h.
  Image observation(const Particle& p, const Landmark& landmark,
                    const Matrix<2>& map_covariance) const {
    const SmallMatrix S =
        blocks({chol_in(across_first_with_heading(p.pose, landmark.mean), p.covariance),
                chol_in(across_first(p.pose, landmark.mean), map_covariance), R_.cwiseSqrt()});
    return unscented(stacked(p.pose, landmark.mean, 7), S, augmented_, observation_model());
  }

  /// Points of the landmark through h from a known pose, plus R.
  Image observation_from(const Vector<3>& pose, const Landmark& landmark) const {
    const SmallMatrix S = chol_in(across_first(pose, landmark.mean), landmark.covariance);
    Image image = unscented(landmark.mean, S, landmark_, landmark_model(as_pose(pose)));
    image.covariance += R_;
    return image;
  }

  Unscented landmark_, augmented_;
  bool map_uncertainty_;
};

}  // namespace montecarta::filters::plain
