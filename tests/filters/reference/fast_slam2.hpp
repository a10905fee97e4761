// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/reference/fast_slam.hpp"

#include <Eigen/Geometry>

#include <optional>

namespace montecarta::filters::reference {

/// FastSLAM II (EQUATIONS 6): the pose Gaussian is refined by the scan, weighed, and a pose drawn
/// from it. Filters with other Gaussians differ in move_gaussian(), update_with() and
/// log_likelihood().
class FastSlam2 : public FastSlam {
 public:
  FastSlam2(const FastSlamSettings& settings, Weight weight)
      : FastSlam(settings), weight_(weight) {}

  /// Before the next step: the Gaussians before drawing. Afterwards: poses with the covariance
  /// gathered since.
  PoseEstimate estimate() const override {
    if (weighs_draws()) return {drawn(), std::nullopt};
    return {drawn(), mixture_moments(
                         particles_, [](const Particle& p) { return p.refined_pose; },
                         [](const Particle& p) { return p.refined_covariance; })};
  }

 protected:
  /// Whether the weights are of the drawn poses: then there is no mixture (EQUATIONS 19).
  virtual bool weighs_draws() const { return weight_ == Weight::ratio; }

  /// Carries (p.pose, p.covariance) through one step.
  virtual void move_gaussian(Particle& p, const Control& control, double duration) const {
    const auto step = linearised_move(as_pose(p.pose), control, duration, settings_.belief.vehicle);
    const Eigen::Matrix3d Fx = pose_jacobian(step.jacobians);
    const Matrix32 Fu = control_jacobian(step.jacobians);
    p.covariance = (Fx * p.covariance * Fx.transpose() + Fu * Q_ * Fu.transpose()).eval();
    p.pose = Eigen::Vector3d(step.pose.x, step.pose.y, step.pose.heading);
  }

  /// EQUATIONS 6: refines (p.pose, p.covariance) by one detection and returns log N(nu; S_z);
  /// nothing where the landmark is too near.
  virtual std::optional<double> update_with(Particle& p, const Landmark& landmark,
                                            const Detection& detection) const {
    const auto seen = seen_from(p.pose, landmark, detection, R_);
    if (!seen) return std::nullopt;
    const Eigen::Matrix2d S_z = seen->Hx * p.covariance * seen->Hx.transpose() + seen->S_f;
    const Matrix32 K = p.covariance * seen->Hx.transpose() * S_z.inverse();
    p.pose += K * seen->nu;
    p.pose(2) = wrap(p.pose(2));
    p.covariance -= (K * S_z * K.transpose()).eval();
    return log_gaussian<2>(seen->nu, S_z);
  }

  /// log p(z | pose, landmark) at a pose that is taken for exact.
  virtual std::optional<double> log_likelihood(const Eigen::Vector3d& pose,
                                               const Landmark& landmark,
                                               const Detection& detection) const {
    const auto seen = seen_from(pose, landmark, detection, R_);
    if (!seen) return std::nullopt;
    return log_gaussian<2>(seen->nu, seen->S_f);
  }

  /// One detection after the other, each where the last one led; returns the closed form (c).
  double refine(Particle& p, Scan scan) const {
    double log_evidence = 0.0;
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (p.pairings[k].kind != PairingKind::matched) continue;
      log_evidence += update_with(p, *p.map[p.pairings[k].landmark], scan[k]).value_or(0.0);
    }
    return log_evidence;
  }

  void predict_particle(const StepContext&, std::uint32_t, Particle& p, const Control& control,
                        double duration) final {
    move_gaussian(p, control, duration);
    p.refined_pose = p.pose;
    p.refined_covariance = p.covariance;
  }

  void weigh_and_draw(const StepContext& context, std::uint32_t i, Particle& p,
                      Scan scan) override {
    const Eigen::Vector3d predicted = p.pose;
    const Eigen::Matrix3d P_predicted = p.covariance;
    const double log_stacked = weight_ == Weight::batch ? log_batch(p, scan) : 0.0;
    const double log_closed = refine(p, scan);
    p.refined_pose = p.pose;
    p.refined_covariance = p.covariance;
    draw_pose(context.stream(Draw::pose_proposal, i), p);
    switch (weight_) {
      case Weight::closed:
        p.log_weight += log_closed;
        break;
      case Weight::batch:
        p.log_weight += log_stacked;
        break;
      case Weight::ratio:
        p.log_weight += log_ratio(p, scan, predicted, P_predicted);
        break;
    }
  }

 private:
  /// Form (b): the density of the stacked innovation, linearised at the predicted pose.
  double log_batch(const Particle& p, Scan scan) const {
    Eigen::MatrixXd H(2 * scan.size(), 3);
    Eigen::VectorXd nu(2 * scan.size());
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(H.rows(), H.rows());
    Eigen::Index rows = 0;
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (p.pairings[k].kind != PairingKind::matched) continue;
      const auto seen = seen_from(p.pose, *p.map[p.pairings[k].landmark], scan[k], R_);
      if (!seen) continue;
      H.middleRows<2>(rows) = seen->Hx;
      nu.segment<2>(rows) = seen->nu;
      S.block<2, 2>(rows, rows) = seen->S_f;
      rows += 2;
    }
    if (rows == 0) return 0.0;
    const Eigen::MatrixXd Hx = H.topRows(rows);
    const Eigen::VectorXd v = nu.head(rows);
    const Eigen::MatrixXd S_z = Hx * p.covariance * Hx.transpose() + S.topLeftCorner(rows, rows);
    return log_gaussian<Eigen::Dynamic>(v, S_z);
  }

  /// x + chol(P) eps; the pose then is exact.
  void draw_pose(RngStream draw, Particle& p) const {
    Eigen::Vector3d eps;
    for (int k = 0; k < 3; ++k) eps(k) = draw.normal();
    Eigen::Matrix3d ahead = Eigen::Matrix3d::Identity();  // from the vehicle's frame into the map's
    ahead.topLeftCorner<2, 2>() = Eigen::Rotation2D<double>(p.pose(2)).toRotationMatrix();
    p.pose += ahead * psd_chol<3>(ahead.transpose() * p.covariance * ahead) * eps;
    p.pose(2) = wrap(p.pose(2));
    p.covariance.setZero();
    p.factor.setZero();
  }

  /// Form (r): likelihood at the drawn pose times prior over proposal there (Bailey et al. 2006).
  double log_ratio(const Particle& p, Scan scan, const Eigen::Vector3d& predicted,
                   const Eigen::Matrix3d& P_predicted) const {
    double likelihood = 0.0;
    bool matched = false;
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (p.pairings[k].kind != PairingKind::matched) continue;
      const auto seen = log_likelihood(p.pose, *p.map[p.pairings[k].landmark], scan[k]);
      likelihood += seen.value_or(0.0);
      matched = matched || seen;
    }
    if (!matched) return 0.0;
    const Eigen::Matrix3d floor = Eigen::Vector3d(1e-12, 1e-12, 1e-14).asDiagonal();
    const Eigen::Vector3d from_prior = boxminus(as_pose(p.pose), as_pose(predicted));
    const Eigen::Vector3d from_proposal = boxminus(as_pose(p.pose), as_pose(p.refined_pose));
    return likelihood + log_gaussian<3>(from_prior, P_predicted + floor) -
           log_gaussian<3>(from_proposal, p.refined_covariance + floor);
  }

  Weight weight_;
};

}  // namespace montecarta::filters::reference
