// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/reference/fast_slams.hpp"
#include "tests/filters/reference/particle.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace montecarta::filters::reference {

/// The skeleton of EQUATIONS 4, particle by particle and step by step: what production is held to
/// and compared with in speed. Filters differ in predict() and in how they refine(), weigh and
/// draw.
class FastSlam : public SlamFilter {
 public:
  explicit FastSlam(const FastSlamSettings& settings)
      : settings_(settings), log_p0_(log_unmatched(settings.association, settings.belief)) {
    const Belief& b = settings.belief;
    R_ = Eigen::Vector2d(b.sigma_range * b.sigma_range, b.sigma_bearing * b.sigma_bearing)
             .asDiagonal();
    Q_ = Eigen::Vector2d(b.control.sigma[0] * b.control.sigma[0],
                         b.control.sigma[1] * b.control.sigma[1])
             .asDiagonal();
  }

  void start(const Pose& start) override {
    Particle first;
    first.pose = first.refined_pose = Eigen::Vector3d(start.x, start.y, start.heading);
    first.log_weight = -std::log(static_cast<double>(settings_.particles));
    if (known()) first.map.resize(settings_.landmarks);
    particles_.assign(settings_.particles, first);
    for (std::uint32_t i = 0; i < particles_.size(); ++i) particles_[i].ancestor = i;
    report_ = {};
    after_update_ = false;
  }

  void predict(const StepContext& context, const Control& control, double duration) final {
    resample();
    for (std::uint32_t i = 0; i < particles_.size(); ++i) {
      predict_particle(context, i, particles_[i], control, duration);
    }
  }

  void update(const StepContext& context, Scan scan) final {
    resample();
    after_update_ = true;
    for (Particle& p : particles_) associate(p, scan);  // step 1
    report_ = {.ess = effective()};
    if (nothing_to_use()) return;  // step 2
    for (std::uint32_t i = 0; i < particles_.size(); ++i) {
      weigh_and_draw(context, i, particles_[i], scan);  // step 3
      if (!known()) particles_[i].log_weight += log_p0_ * unmatched(particles_[i]);
    }
    normalise();                                          // step 4
    for (Particle& p : particles_) update_maps(p, scan);  // step 5
    if (report_.ess < settings_.threshold * static_cast<double>(particles_.size())) {
      report_.resampled =
          true;  // step 6: takes effect with the next call, so that the scan can be recorded
      parents_ = draw_parents(settings_.scheme, weights(), context);
    }
    for (Particle& p : particles_) add_new_landmarks(p, scan);  // step 7
  }

  const ScanReport& report() const final { return report_; }
  const std::vector<Particle>& population() const { return particles_; }

  void particles(const ParticleColumns& columns) const final {
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      for (std::size_t k = 0; k < 3 && !columns.pose.empty(); ++k) {
        columns.pose[3 * i + k] = particles_[i].pose(static_cast<Eigen::Index>(k));
      }
      if (!columns.log_weight.empty()) columns.log_weight[i] = particles_[i].log_weight;
      if (!columns.ancestor.empty()) columns.ancestor[i] = particles_[i].ancestor;
    }
  }

  /// Maps are compared particle by particle, through population().
  void map(std::span<std::optional<LandmarkEstimate>>) const final {}

 protected:
  virtual void predict_particle(const StepContext& context, std::uint32_t i, Particle& p,
                                const Control& control, double duration) = 0;
  virtual void weigh_and_draw(const StepContext& context, std::uint32_t i, Particle& p,
                              Scan scan) = 0;
  /// Steps 5 and 7 for one landmark, at a pose that is taken for exact.
  virtual void update_map(const Eigen::Vector3d& pose, Landmark& landmark,
                          const Detection& detection) const {
    if (const auto seen = seen_from(pose, landmark, detection, R_)) {
      update_landmark(landmark, *seen, R_);
    }
  }
  virtual Landmark initialised(const Eigen::Vector3d& pose, const Detection& detection) const {
    return new_landmark(pose, detection, R_);
  }

  bool known() const { return settings_.association.kind == Association::known; }
  PoseMoments drawn() const {
    return mixture_moments(
        particles_, [](const Particle& p) { return p.pose; },
        [](const Particle&) { return Eigen::Matrix3d::Zero(); });
  }

  FastSlamSettings settings_;
  double log_p0_;
  Eigen::Matrix2d R_;
  Eigen::Matrix2d Q_;
  std::vector<Particle> particles_;

 private:
  void associate(Particle& p, Scan scan) const {
    const NearestNeighbour nearest{settings_.association, R_, p.pose, p.covariance};
    p.pairings = known() ? pair_by_identity(scan, p.map) : nearest.pair(scan, p.map);
  }

  bool nothing_to_use() const {
    for (const Particle& p : particles_) {
      for (const Pairing& pairing : p.pairings) {
        if (pairing.kind != PairingKind::ignored) return false;
      }
    }
    return true;
  }

  static double unmatched(const Particle& p) {
    double count = 0.0;
    for (const Pairing& pairing : p.pairings) count += pairing.kind != PairingKind::matched;
    return count;
  }

  void normalise() {
    double peak = particles_[0].log_weight;
    for (const Particle& p : particles_) peak = std::max(peak, p.log_weight);
    double sum = 0.0;
    for (const Particle& p : particles_) sum += std::exp(p.log_weight - peak);
    report_.log_likelihood = peak + std::log(sum);
    for (Particle& p : particles_) p.log_weight -= report_.log_likelihood;
    report_.ess = effective();
  }

  std::vector<double> weights() const {
    std::vector<double> weights;
    for (const Particle& p : particles_) weights.push_back(std::exp(p.log_weight));
    return weights;
  }

  double effective() const {
    double squares = 0.0;
    for (const double w : weights()) squares += w * w;
    return 1.0 / squares;
  }

  void update_maps(Particle& p, Scan scan) const {
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (p.pairings[k].kind != PairingKind::matched) continue;
      update_map(p.pose, *p.map[p.pairings[k].landmark], scan[k]);
    }
  }

  void add_new_landmarks(Particle& p, Scan scan) const {
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (p.pairings[k].kind != PairingKind::fresh) continue;
      const Landmark landmark = initialised(p.pose, scan[k]);
      if (known()) {
        p.map[p.pairings[k].landmark] = landmark;
      } else {
        p.map.emplace_back(landmark);
      }
    }
  }

  /// Once between two scans: what the last one decided takes effect.
  void resample() {
    if (!std::exchange(after_update_, false)) return;
    for (std::uint32_t i = 0; i < particles_.size(); ++i) particles_[i].ancestor = i;
    if (!report_.resampled) return;
    std::vector<Particle> next;
    next.reserve(particles_.size());
    for (const std::uint32_t parent : parents_) {
      next.push_back(particles_[parent]);
      next.back().ancestor = parent;
      next.back().log_weight = -std::log(static_cast<double>(particles_.size()));
    }
    particles_ = std::move(next);
  }

  ScanReport report_;
  std::vector<std::uint32_t> parents_;  ///< of the last resampling
  bool after_update_ = false;
};

/// FastSLAM I (EQUATIONS 5): poses are drawn from the motion model at every step, and weighed by
/// the scan.
class FastSlam1 : public FastSlam {
 public:
  using FastSlam::FastSlam;
  PoseEstimate estimate() const override { return {drawn(), std::nullopt}; }

 private:
  void predict_particle(const StepContext& context, std::uint32_t i, Particle& p,
                        const Control& control, double duration) override {
    const Belief& belief = settings_.belief;
    RngStream draw = context.stream(Draw::motion_sample, i);
    const double speed = control[0] + belief.control.sigma[0] * draw.normal();
    const double steer = control[1] + belief.control.sigma[1] * draw.normal();
    const Pose moved = move(as_pose(p.pose), Control{speed, steer}, duration, belief.vehicle);
    p.pose = Eigen::Vector3d(moved.x, moved.y, moved.heading);
  }

  void weigh_and_draw(const StepContext&, std::uint32_t, Particle& p, Scan scan) override {
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (p.pairings[k].kind != PairingKind::matched) continue;
      const auto seen = seen_from(p.pose, *p.map[p.pairings[k].landmark], scan[k], R_);
      if (seen) p.log_weight += log_gaussian<2>(seen->nu, seen->S_f);
    }
  }
};

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
