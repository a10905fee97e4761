// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/plain/particle.hpp"
#include "filters/plain/resampling.hpp"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace montecarta::filters::plain {

/// The part that all FastSLAM filters share (EQUATIONS 4), particle by particle and step by step. A
/// filter adds how a particle is predicted, and how it is weighed and its pose drawn.
class FastSlam : public SlamFilter {
 public:
  explicit FastSlam(const FilterSetup& setup)
      : setup_(setup),
        belief_(setup.belief),
        R_(observation_noise(setup.belief)),
        scheme_(setup.options.choice("resampling") == "systematic" ? Resampling::systematic
                                                                   : Resampling::stratified) {}

  void start(const Pose& start) override {
    start_from(StepContext::before_all_steps(), {.pose = {start}});
  }
  /// All particles have the known map.
  void start_from(const StepContext& context, const Prior& prior) override {
    const Vector<3> mean = to_vector(prior.pose.mean);
    const Matrix<3> root = root_along(mean(2), prior.pose.covariance);
    particles_.assign(setup_.options.integer("particles"), {});
    for (std::uint32_t i = 0; i < particles_.size(); ++i) {
      Particle& p = particles_[i];
      place_at_start(mean, root, context.stream(Draw::start_sample, i), p);
      p.refined_pose = p.pose;
      p.refined_covariance = p.covariance;
      p.log_weight = -std::log(size());
      p.map = known_map(prior.map);
    }
    forget_ancestors();
    report_ = {};
    fix_.reset();
    is_after_scan_ = false;
  }

  void predict(const StepContext& context, const Control& control, double duration) final {
    resample();
    for (std::uint32_t i = 0; i < particles_.size(); ++i)
      predict_particle(context, i, particles_[i], control, duration);
  }

  void take_fix(const PositionFix& fix) final { fix_ = fix; }

  /// The steps (1) to (6) of EQUATIONS 4.
  void update(const StepContext& context, Scan scan) final {
    resample();
    is_after_scan_ = true;
    report_ = {.ess = effective_size(particles_)};
    for (Particle& p : particles_) {
      p.log_weight_of_fix = fix_ ? use_fix(*fix_, p) : 0.0;
      p.pairings = pair(scan, p.map, p.pose, p.covariance, setup_);
    }
    const bool is_used = fix_ || uses_anything();
    fix_.reset();
    if (is_used) {
      innovations_.assign(scan.size(), {});
      for (std::uint32_t i = 0; i < particles_.size(); ++i) use_scan(context, i, scan);
      for (const MixtureInnovation& one : innovations_) one.add_to(report_);
      for (Particle& p : particles_) update_landmarks(p, scan);
      report_.log_likelihood = normalise(particles_);
      report_.ess = effective_size(particles_);
    }
    report_.association = mean_counts(particles_, scan);
    for (Particle& p : particles_) initialise_landmarks(p, scan);
    for (const Particle& p : particles_)
      report_.map_size += std::exp(p.log_weight) * static_cast<double>(p.map.size());
    if (is_used) decide_on_resampling(context);
  }

  const ScanReport& report() const final { return report_; }
  void particles(const ParticleColumns& columns) const final {
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      const Particle& p = particles_[i];
      write_particle(columns, i, p.pose, p.log_weight, p.ancestor);
    }
  }
  /// With known association all particles have the same landmarks; otherwise these are those of the
  /// heaviest one.
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const final {
    const Association kind = setup_.association.kind;
    const Map& map = heaviest(particles_).map;
    for (std::size_t k = 0; k < landmarks.size(); ++k) {
      landmarks[k].reset();
      const auto slot = slot_of(k, identities_of(map), kind);
      if (!slot) continue;
      landmarks[k] = kind == Association::known
                         ? mixture_of_landmarks(particles_, *slot)
                         : LandmarkEstimate{map[*slot].mean, map[*slot].covariance};
    }
  }

  const std::vector<Particle>& population() const { return particles_; }

 protected:
  /// Places a particle by the prior N(mean, root root') of the pose at the start.
  virtual void place_at_start(const Vector<3>& mean, const Matrix<3>& root, RngStream stream,
                              Particle& p) const = 0;
  virtual void predict_particle(const StepContext& context, std::uint32_t i, Particle& p,
                                const Control& control, double duration) = 0;
  /// Multiplies the weight of a particle by the likelihood of the scan, and draws its pose.
  virtual void weigh_and_draw(const StepContext& context, std::uint32_t i, Particle& p,
                              Scan scan) = 0;

  /// Updates a landmark that is observed from a pose which counts as exact.
  virtual void update_map(const Vector<3>& pose, Landmark& landmark, const Detection& z) const {
    if (const auto v = innovation_at(pose, landmark, z, R_)) update_landmark(landmark, *v, R_);
  }
  /// Initialises a landmark from a pose which counts as exact.
  virtual Landmark initialised(const Vector<3>& pose, const Detection& z) const {
    return new_landmark(pose, z, R_);
  }
  /// The innovation of a landmark observed from a pose which counts as exact; nullopt if the
  /// landmark is too near.
  virtual std::optional<Innovation> innovation(const Vector<3>& pose, const Landmark& landmark,
                                               const Detection& z) const {
    return linearised_innovation(pose, landmark, z);
  }
  std::optional<Innovation> linearised_innovation(const Vector<3>& pose, const Landmark& landmark,
                                                  const Detection& z) const {
    const auto v = innovation_at(pose, landmark, z, R_);
    return v ? std::optional(Innovation{v->nu, v->Sf}) : std::nullopt;
  }
  /// The log-density of an innovation; 0 if there is none.
  static double log_density_of(const std::optional<Innovation>& v) {
    return v ? log_gaussian(*v) : 0.0;
  }

  /// Calls visit(landmark, k) for each match of a particle with scan[k], in the order of the scan.
  template <class Visit>
  static void for_each_match(Particle& p, Scan scan, const Visit& visit) {
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (p.pairings[k].kind == PairingKind::matched) visit(p.map[p.pairings[k].landmark], k);
    }
  }
  /// The log-density of the innovation of scan[k], which is added to the mixture for the NIS. A
  /// detection is left out and counted if its landmark is too near.
  double counted(std::size_t k, const std::optional<Innovation>& v) {
    if (v) innovations_[k].add(weight_before_, *v);
    if (!v) ++report_.numerical_faults;
    return log_density_of(v);
  }

  FilterSetup setup_;
  Belief belief_;
  Matrix<2> R_;
  std::vector<Particle> particles_;

 private:
  double size() const { return static_cast<double>(particles_.size()); }
  void forget_ancestors() {
    for (std::uint32_t i = 0; i < particles_.size(); ++i) particles_[i].ancestor = i;
  }

  bool uses_anything() const {
    const auto is_used = [](const Pairing& one) { return one.kind != PairingKind::ignored; };
    return std::ranges::any_of(
        particles_, [&](const Particle& p) { return std::ranges::any_of(p.pairings, is_used); });
  }

  /// Conditions the pose of a particle on a fix of the position and returns the log of the density
  /// of its innovation (EQUATIONS (24.1)). A pose that counts as exact does not move.
  double use_fix(const PositionFix& fix, Particle& p) const {
    const double sigma = belief_.sigma_fix.value();
    const Vector<2> nu = fix - p.pose.head<2>();
    const Matrix<2> S = p.covariance.topLeftCorner<2, 2>() + sigma * sigma * Matrix<2>::Identity();
    const Matrix<3, 2> K = gain<3, 2>(p.covariance.leftCols<2>(), S);
    p.pose += K * nu;
    p.pose(2) = wrap(p.pose(2));
    p.covariance -= (K * S * K.transpose()).eval();
    p.factor = root_along(p.pose(2), p.covariance);
    return log_gaussian<2>(nu, S);
  }

  void use_scan(const StepContext& context, std::uint32_t i, Scan scan) {
    Particle& p = particles_[i];
    weight_before_ = std::exp(p.log_weight);
    weigh_and_draw(context, i, p, scan);
    p.log_weight += p.log_weight_of_fix;
    for (const Pairing& one : p.pairings) {
      if (one.kind != PairingKind::matched) p.log_weight += log_unmatched(setup_);
    }
  }
  void update_landmarks(Particle& p, Scan scan) const {
    for_each_match(
        p, scan, [&](Landmark& landmark, std::size_t k) { update_map(p.pose, landmark, scan[k]); });
  }
  void initialise_landmarks(Particle& p, Scan scan) const {
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (p.pairings[k].kind != PairingKind::fresh) continue;
      p.map.push_back(initialised(p.pose, scan[k]));
      p.map.back().identity = scan[k].identity;
    }
    refuse_large_map(p.map.size(), setup_.association);
  }

  /// Draws the parents. They take effect at the next step, so that the particles of this scan can
  /// be recorded.
  void decide_on_resampling(const StepContext& context) {
    report_.resampled = report_.ess < setup_.options.number("resample_below") * size();
    if (report_.resampled) parents_ = parents_by(scheme_, weights_of(particles_), context);
  }
  void resample() {
    if (!std::exchange(is_after_scan_, false)) return;
    forget_ancestors();
    if (!report_.resampled) return;
    std::vector<Particle> next;
    for (const std::uint32_t parent : parents_) {
      next.push_back(particles_[parent]);
      next.back().ancestor = parent;
      next.back().log_weight = -std::log(size());
    }
    particles_ = std::move(next);
  }

  Resampling scheme_;
  ScanReport report_;
  std::optional<PositionFix> fix_;              ///< fix for the next scan
  double weight_before_ = 0.0;                  ///< of the present particle, before the scan
  std::vector<MixtureInnovation> innovations_;  ///< {detection}
  std::vector<std::uint32_t> parents_;          ///< of the pending resampling
  bool is_after_scan_ = false;
};

}  // namespace montecarta::filters::plain
