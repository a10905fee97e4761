// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/reference/fast_slam.hpp"
#include "tests/filters/reference/textbook_ekf_slam.hpp"

#include <vector>

namespace montecarta::filters::reference {

/// FastSLAM II that draws poses at every `every`-th scan (EQUATIONS 11), each particle a
/// full EKF-SLAM in between; known association, no clutter.
class DelayedFastSlam final : public SlamFilter {
 public:
  DelayedFastSlam(const FastSlamSettings& settings, std::size_t every)
      : settings_(settings), every_(every) {}

  void start(const Pose& start) override {
    particles_.assign(settings_.particles, Particle(settings_.belief));
    for (Particle& p : particles_) p.joint.start(start);
    for (Particle& p : particles_) p.log_weight = -std::log(settings_.particles);
    report_ = {};
    scans_ = 0;
    draws_ = after_update_ = false;
    drew_ = true;
  }
  void predict(const StepContext&, const Control& control, double duration) override {
    resample();
    draws_ = false;
    for (Particle& p : particles_) p.joint.predict(control, duration);
  }
  void update(const StepContext& context, Scan scan) override {
    resample();
    after_update_ = true;
    report_ = {.ess = effective()};
    if (scan.empty()) return;
    draws_ = every_ > 0 && ++scans_ >= every_;
    for (std::uint32_t i = 0; i < particles_.size(); ++i) weigh(context, i, particles_[i], scan);
    normalise();
    if (draws_) scans_ = 0;
    drew_ = draws_;
    if (report_.ess >= settings_.threshold * static_cast<double>(particles_.size())) return;
    report_.resampled = true;
    std::vector<double> weights;
    for (const Particle& p : particles_) weights.push_back(std::exp(p.log_weight));
    parents_ = draw_parents(settings_.scheme, weights, context);
  }
  /// At a scan that draws: the cloud, and the Gaussians it was drawn from. Afterwards: the cloud
  /// moved on, and with the covariance gathered since. Without a draw there is no cloud.
  PoseEstimate estimate() const override {
    const PoseMoments mixture = moments(!draws_, 1.0);
    return {drew_ ? moments(true, 0.0) : mixture, mixture};
  }
  const ScanReport& report() const override { return report_; }
  void map(std::span<std::optional<LandmarkEstimate>>) const override {}

 private:
  struct Particle {
    explicit Particle(const Belief& belief) : joint(belief) {}
    TextbookEkfSlam joint;
    Eigen::Vector3d refined_mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d refined_covariance = Eigen::Matrix3d::Zero();
    double log_weight = 0.0;
  };

  /// Of the poses as they are now, or as refined before the draw.
  PoseMoments moments(bool now, double own) const {
    std::vector<reference::Particle> gaussians(particles_.size());
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
      const Particle& p = particles_[i];
      gaussians[i].log_weight = p.log_weight;
      gaussians[i].pose = now ? Eigen::Vector3d(p.joint.mean.head<3>()) : p.refined_mean;
      const Eigen::Matrix3d P = p.joint.covariance.topLeftCorner<3, 3>();
      gaussians[i].covariance = own * (now ? P : p.refined_covariance);
    }
    return mixture_moments(
        gaussians, [](const auto& p) { return p.pose; },
        [](const auto& p) { return p.covariance; });
  }

  Eigen::Matrix2d R() const {
    const Belief& b = settings_.belief;
    return Eigen::Vector2d(std::pow(b.sigma_range, 2), std::pow(b.sigma_bearing, 2)).asDiagonal();
  }
  double log_density(const TextbookEkfSlam& joint, const Detection& detection) const {
    const auto [observation, H] = joint.look(joint.row_of(detection.identity));
    const Eigen::Matrix2d S = sandwich(H, joint.covariance) + R();
    return log_gaussian<2>(to_vector(residual(observation_of(detection), observation)), S);
  }

  void weigh(const StepContext& context, std::uint32_t i, Particle& p, Scan scan) const {
    const TextbookEkfSlam prior = p.joint;
    std::vector<Detection> again, fresh;
    for (const Detection& detection : scan) {
      (prior.row_of(detection.identity) < 0 ? fresh : again).push_back(detection);
    }
    for (const Detection& detection : again) {
      p.log_weight += log_density(p.joint, detection);
      p.joint.update({&detection, 1});
    }
    if (draws_) {
      p.refined_mean = p.joint.mean.head<3>();
      p.refined_covariance = p.joint.covariance.topLeftCorner<3, 3>();
      const Eigen::Vector3d drawn = draw_pose(context.stream(Draw::pose_proposal, i), p);
      p.joint = prior;
      condition(p.joint, drawn);
      p.joint.update(again);
    }
    p.joint.update(fresh);
  }

  static Eigen::Vector3d draw_pose(RngStream draw, const Particle& p) {
    Eigen::Vector3d eps;
    for (int k = 0; k < 3; ++k) eps(k) = draw.normal();
    Eigen::Matrix3d ahead = Eigen::Matrix3d::Identity();
    ahead.topLeftCorner<2, 2>() = Eigen::Rotation2D<double>(p.refined_mean(2)).toRotationMatrix();
    return p.refined_mean +
           ahead * psd_chol<3>(ahead.transpose() * p.refined_covariance * ahead) * eps;
  }

  /// The landmarks given that the pose is `drawn`; then their correlations are forgotten.
  static void condition(TextbookEkfSlam& joint, const Eigen::Vector3d& drawn) {
    const Eigen::Index n = joint.mean.size() - 3;
    const Eigen::Matrix3d P = joint.covariance.topLeftCorner<3, 3>();
    const Eigen::MatrixXd P_fx = joint.covariance.bottomLeftCorner(n, 3);
    const Eigen::Matrix3d per_P = P.completeOrthogonalDecomposition().pseudoInverse();
    const Eigen::MatrixXd gain = product(P_fx, per_P);
    joint.mean.tail(n) += product(gain, boxminus(as_pose(drawn), joint.pose()));
    const Eigen::MatrixXd given =
        joint.covariance.bottomRightCorner(n, n) - product(gain, P_fx.transpose());
    joint.mean.head<3>() << drawn.head<2>(), wrap(drawn(2));
    joint.covariance.setZero();
    for (Eigen::Index k = 3; k < n + 3; k += 2) {
      joint.covariance.block<2, 2>(k, k) = given.block<2, 2>(k - 3, k - 3);
    }
  }

  double effective() const {
    double squares = 0.0;
    for (const Particle& p : particles_) squares += std::exp(2.0 * p.log_weight);
    return 1.0 / squares;
  }
  void normalise() {
    double sum = 0.0, peak = particles_[0].log_weight;
    for (const Particle& p : particles_) peak = std::max(peak, p.log_weight);
    for (const Particle& p : particles_) sum += std::exp(p.log_weight - peak);
    report_.log_likelihood = peak + std::log(sum);
    for (Particle& p : particles_) p.log_weight -= report_.log_likelihood;
    report_.ess = effective();
  }
  void resample() {
    if (!std::exchange(after_update_, false) || !report_.resampled) return;
    std::vector<Particle> next;
    for (const std::uint32_t parent : parents_) {
      next.push_back(particles_[parent]);
      next.back().log_weight = -std::log(settings_.particles);
    }
    particles_ = std::move(next);
  }

  FastSlamSettings settings_;
  std::size_t every_;
  std::size_t scans_ = 0;
  std::vector<Particle> particles_;
  std::vector<std::uint32_t> parents_;
  ScanReport report_;
  bool draws_ = false;  ///< at this scan, until the next step
  bool drew_ = true;    ///< at the last scan
  bool after_update_ = false;
};

}  // namespace montecarta::filters::reference
