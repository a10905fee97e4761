// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/reference/association.hpp"
#include "tests/filters/reference/fast_slams.hpp"
#include "tests/filters/reference/gaussian.hpp"
#include "tests/filters/reference/particle_moments.hpp"
#include "tests/filters/reference/resampling.hpp"

#include <cmath>
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

}  // namespace montecarta::filters::reference
