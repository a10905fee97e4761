// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/plain/fast_slam.hpp"

#include <string>

namespace montecarta::filters::plain {

/// FastSLAM II (EQUATIONS 6; Montemerlo et al. 2003): the scan refines the Gaussian of the pose
/// before the pose is drawn. UFastSlam and Srcd have other Gaussians: they replace move_gaussian(),
/// update_with(), innovation() and the two functions that keep landmarks. A change of
/// weigh_and_draw() changes them too.
class FastSlam2 : public FastSlam {
 public:
  explicit FastSlam2(const FilterSetup& setup)
      : FastSlam2(setup, setup.options.choice("weights")) {}

  /// After a scan the mixture is that of the Gaussians before the draw.
  PoseEstimate estimate() const override {
    PoseEstimate estimate{spread_of(particles_), std::nullopt};
    if (weighs_draws()) return estimate;
    estimate.mixture = mixture_moments(
        particles_, [](const Particle& p) { return p.refined_pose; },
        [](const Particle& p) { return p.refined_covariance; });
    return estimate;
  }

 protected:
  FastSlam2(const FilterSetup& setup, std::string weights)
      : FastSlam(setup), weights_(std::move(weights)) {}

  /// Returns whether the weights are those of the drawn poses, so that there is no mixture
  /// (EQUATIONS 19). FilterKind::reports.mixture must say the same, else the runs fail.
  virtual bool weighs_draws() const { return weights_ == "ratio"; }

  /// The prior is the Gaussian of each particle, which the first scan refines before the draw.
  void place_at_start(const Vector<3>& mean, const Matrix<3>& root, RngStream /*stream*/,
                      Particle& p) const final {
    p.pose = mean;
    p.covariance = root * root.transpose();
    p.factor = root;
  }

  /// Moves (p.pose, p.covariance) by one step.
  virtual void move_gaussian(Particle& p, const Control& control, double duration) const {
    move_linearised(p.pose, p.covariance, control, duration, belief_);
  }

  /// Refines (p.pose, p.covariance) by one detection (EQUATIONS (6.1)) and returns its
  /// innovation; nullopt if the landmark is too near.
  virtual std::optional<Innovation> update_with(Particle& p, const Landmark& landmark,
                                                const Detection& z) const {
    const auto v = innovation_at(p.pose, landmark, z, R_);
    if (!v) return std::nullopt;
    const Matrix<2> S = v->Hx * p.covariance * v->Hx.transpose() + v->Sf;
    const Matrix<3, 2> K = gain<3, 2>(p.covariance * v->Hx.transpose(), S);
    p.pose += K * v->nu;
    p.pose(2) = wrap(p.pose(2));
    p.covariance -= (K * S * K.transpose()).eval();
    return Innovation{v->nu, S};
  }

  void predict_particle(const StepContext& /*context*/, std::uint32_t /*i*/, Particle& p,
                        const Control& control, double duration) final {
    move_gaussian(p, control, duration);
    p.refined_pose = p.pose;
    p.refined_covariance = p.covariance;
  }

  /// Refines by one detection after the other and returns the logarithm of EQUATIONS (6.2).
  double refine(Particle& p, Scan scan) {
    double log_evidence = 0.0;
    for_each_match(p, scan, [&](const Landmark& landmark, std::size_t k) {
      log_evidence += counted(k, update_with(p, landmark, scan[k]));
    });
    p.refined_pose = p.pose;
    p.refined_covariance = p.covariance;
    return log_evidence;
  }

  void weigh_and_draw(const StepContext& context, std::uint32_t i, Particle& p,
                      Scan scan) override {
    const Particle predicted = p;
    const double log_closed = refine(p, scan);
    place(p, drawn_from(p.pose, root_along(p.pose(2), p.covariance),
                        context.stream(Draw::pose_proposal, i)));
    if (weights_ == "closed") p.log_weight += log_closed;
    if (weights_ == "batch") p.log_weight += log_batch(predicted, scan);
    if (weights_ == "ratio") p.log_weight += log_ratio(p, predicted, p.refined_pose, 1.0, scan);
  }

  /// Puts a particle at a drawn pose, which counts as exact.
  static void place(Particle& p, const Vector<3>& pose) {
    p.pose = pose;
    p.covariance.setZero();
    p.factor.setZero();
  }

  /// The logarithm of EQUATIONS (6.3): the likelihood at the drawn pose times prior over proposal.
  /// The proposal is N(centre, inflation * refined covariance).
  double log_ratio(Particle& p, const Particle& predicted, const Vector<3>& centre,
                   double inflation, Scan scan) const {
    double log_weight = log_density(p.pose, predicted.pose, predicted.covariance) -
                        log_density(p.pose, centre, inflation * p.refined_covariance);
    for_each_match(p, scan, [&](const Landmark& landmark, std::size_t k) {
      log_weight += log_density_of(innovation(p.pose, landmark, scan[k]));
    });
    return log_weight;
  }

 private:
  /// The logarithm of EQUATIONS (6.4): the density of the stacked innovations, linearised at the
  /// predicted pose.
  double log_batch(Particle predicted, Scan scan) const {
    Eigen::MatrixXd H(2 * scan.size(), 3), S = Eigen::MatrixXd::Zero(H.rows(), H.rows());
    Eigen::VectorXd nu(H.rows());
    Eigen::Index rows = 0;
    for_each_match(predicted, scan, [&](const Landmark& landmark, std::size_t k) {
      const auto v = innovation_at(predicted.pose, landmark, scan[k], R_);
      if (!v) return;
      H.middleRows<2>(rows) = v->Hx;
      nu.segment<2>(rows) = v->nu;
      S.block<2, 2>(rows, rows) = v->Sf;
      rows += 2;
    });
    const Eigen::MatrixXd Hx = H.topRows(rows);
    return log_gaussian<Eigen::Dynamic>(
        nu.head(rows), Hx * predicted.covariance * Hx.transpose() + S.topLeftCorner(rows, rows));
  }

  std::string weights_;
};

}  // namespace montecarta::filters::plain
