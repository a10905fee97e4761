// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/gaussian_bank.hpp"

#include "engine/random/normals.hpp"
#include "filters/joint/mixture.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace montecarta::filters {

GaussianBank::GaussianBank(const FilterSetup& setup, const BankSettings& settings)
    : belief_(setup.belief),
      settings_(settings),
      known_(setup.association.kind == Association::known),
      population_(settings.population),
      slot_of_(population_.particles()),
      old_slot_of_(slot_of_) {
  beliefs_.reserve(slot_of_.size());
  FilterSetup idle = setup;  // grows when it becomes a copy
  idle.landmarks = 0;
  for (std::size_t i = 0; i < slot_of_.size(); ++i) {
    beliefs_.emplace_back(i == 0 ? setup : idle, settings.retraction, settings.iterations,
                          settings.moments, settings.linearisation);
  }
}

void GaussianBank::start(const Pose& start) {
  motion_.restart();
  population_.start();
  beliefs_.front().start(start);
  std::fill(slot_of_.begin(), slot_of_.end(), 0U);
  active_.assign(1, 0U);
}

void GaussianBank::predict(const StepContext& /*context*/, const Control& control,
                           double duration) {
  settle();
  advance(motion_, control, duration, belief_, settings_.motion);
}

void GaussianBank::update(const StepContext& context, Scan scan) {
  settle();
  population_.begin_scan();
  context.parallel_for(active_.size(),
                       [&](std::size_t a) { beliefs_[active_[a]].update_with(motion_, scan); });
  motion_.restart();
  gather_innovations(scan);
  weigh();
  estimate_of_scan_ = mixture();
  split(context);
  if (!fixes_landmark(belief_.sensor)) find_advancing(context, scan);
  context.parallel_for(active_.size(), [&](std::size_t a) {
    beliefs_[active_[a]].initialise_landmarks(scan, advancing_);
  });
  for (std::size_t i = 0; i < slot_of_.size(); ++i) {
    population_.report().map_size += weight_of(i) * static_cast<double>(belief_of(i).landmarks());
  }
  population_.decide_on_resampling(context);
}

/// What one detection does not fix all beliefs take a step further in the same scan, so that all of
/// them weigh by the same detections.
void GaussianBank::find_advancing(const StepContext& context, Scan scan) {
  found_.resize(active_.size());
  context.parallel_for(active_.size(), [&](std::size_t a) {
    found_[a] = beliefs_[active_[a]].find_advancing(scan);
  });
  advancing_.assign(scan.size(), true);
  for (const auto& found : found_) {
    for (std::size_t k = 0; k < scan.size(); ++k) advancing_[k] = advancing_[k] && found[k];
  }
}

/// Every particle's weight is multiplied by what its belief expected of the scan.
void GaussianBank::weigh() {
  for (std::size_t i = 0; i < slot_of_.size(); ++i) {
    population_.weigh(i, {belief_of(i).outcome().log_likelihood, 0.0});
  }
  population_.normalise();
  ScanReport& report = population_.report();
  if (!settings_.tells_particles) {  // one Gaussian
    report.ess = 0.0;
    report.rotation_information = beliefs_.front().rotation_information();
  }
  innovations_.add_to(report, components_of(belief_.sensor).size());
  for (std::size_t i = 0; i < slot_of_.size(); ++i) {
    add(belief_of(i).association().counts(), weight_of(i), report.association);
  }
  for (std::uint32_t slot : active_) report.numerical_faults += beliefs_[slot].outcome().faults;
}

void GaussianBank::gather_innovations(Scan scan) {
  innovations_.start(1, scan.size(), 0.0);
  for (std::size_t i = 0; i < slot_of_.size(); ++i) {
    const auto innovations = innovations_.of_block(0, weight_of(i));
    for (const auto& [k, v, S] : belief_of(i).used_detections()) {
      innovations.add(k, {{v(0), v(1)}, {S(0, 0), S(1, 0), S(1, 1)}}, Everywhere());
      innovations_.matched_weight(k) += weight_of(i);
    }
  }
}

/// EQUATIONS 16: the draws decompose the Gaussian (JointGaussian::draw_heading()), so no weight
/// changes.
void GaussianBank::split(const StepContext& context) {
  is_due_.assign(beliefs_.size(), false);
  for (const std::uint32_t slot : active_) is_due_[slot] = is_due(beliefs_[slot]);
  if (std::ranges::find(is_due_, char{true}) == is_due_.end()) return;
  part_those_due();
  deal_strata(context);
  context.parallel_for(strata_.size(), [&](std::size_t stratum) {
    const std::uint32_t particle = strata_[stratum].second;
    const std::uint32_t slot = slot_of_[particle];
    if (!is_due_[slot]) return;
    const double within = context.stream(Draw::heading_split, particle).uniform();
    beliefs_[slot].draw_heading(settings_.keep,
                                normal_quantile((static_cast<double>(stratum) + within) /
                                                static_cast<double>(strata_.size())));
  });
}

/// The particles in random order: each draws from a stratum of its own of the normal distribution,
/// so that the bank as a whole is spread as evenly as it can be.
void GaussianBank::deal_strata(const StepContext& context) {
  strata_.resize(slot_of_.size());
  for (std::uint32_t i = 0; i < strata_.size(); ++i) {
    strata_[i] = {context.stream(Draw::split_stratum, i).uniform(), i};
  }
  std::ranges::sort(strata_);
}

bool GaussianBank::is_due(const JointBelief& belief) const {
  const double variance = belief.gaussian().pose().covariance(2, 2);
  if (settings_.split_beyond) return variance > *settings_.split_beyond * *settings_.split_beyond;
  const double extent = belief.extent();
  return 0.5 * variance * extent > length_deviation(belief_.sensor, belief_, extent);
}

/// Of particles that share a belief that is due, the first keeps it, the others get copies.
void GaussianBank::part_those_due() {
  idle_.clear();
  for (std::uint32_t slot = 0; slot < beliefs_.size(); ++slot) {
    if (!std::ranges::binary_search(active_, slot)) idle_.push_back(slot);
  }
  taken_.assign(beliefs_.size(), false);
  for (std::uint32_t& slot : slot_of_) {
    if (!is_due_[slot] || !taken_[slot]) {
      taken_[slot] = true;
      continue;
    }
    beliefs_[idle_.back()].become(beliefs_[slot]);
    slot = idle_.back();
    is_due_[slot] = true;
    idle_.pop_back();
  }
  note_active();
}

void GaussianBank::note_active() {
  active_ = slot_of_;
  std::ranges::sort(active_);
  active_.erase(std::unique(active_.begin(), active_.end()), active_.end());
}

/// Ends the time in which the particles of the last scan can be asked for: resampling takes effect.
void GaussianBank::settle() {
  if (!population_.resample()) return;
  std::swap(slot_of_, old_slot_of_);
  for (std::size_t i = 0; i < slot_of_.size(); ++i) {
    slot_of_[i] = old_slot_of_[population_.ancestors()[i]];
  }
  note_active();
}

PoseEstimate GaussianBank::mixture() const {
  if (!settings_.tells_particles) return {beliefs_.front().pose_after(motion_), std::nullopt};
  weigh_beliefs();
  poses_.resize(beliefs_.size());
  for (const std::uint32_t slot : active_) {
    poses_[slot] = beliefs_[slot].pose_after(motion_);
  }
  Mixture mixture(poses_[slot_of_[population_.weights().heaviest()]]);
  for (const std::uint32_t slot : active_) mixture.add(slot_weights_[slot], poses_[slot]);
  const PoseMoments whole = mixture.result();
  return {whole, whole};
}

PoseEstimate GaussianBank::estimate() const {
  return population_.is_after_scan() ? estimate_of_scan_ : mixture();
}

void GaussianBank::particles(const ParticleColumns& columns) const {
  population_.tell(columns, [&](std::size_t i) { return belief_of(i).pose_after(motion_).mean; });
}

void GaussianBank::weigh_beliefs() const {
  slot_weights_.assign(beliefs_.size(), 0.0);
  for (std::size_t i = 0; i < slot_of_.size(); ++i) {
    slot_weights_[slot_of_[i]] += weight_of(i);
  }
}

/// Visits every belief that some particle has, with the weight of all that have it:
/// weigh_beliefs() comes first.
template <class Visit>
void GaussianBank::for_beliefs(const Visit& visit) const {
  for (const std::uint32_t slot : active_) visit(slot_weights_[slot], beliefs_[slot]);
}

void GaussianBank::map(std::span<std::optional<LandmarkEstimate>> landmarks) const {
  weigh_beliefs();
  for (std::size_t k = 0; k < landmarks.size(); ++k) landmarks[k] = landmark(k);
}

/// Known association: the mixture of all beliefs, by identity. Otherwise the heaviest particle's
/// map in the order in which it met its landmarks.
std::optional<LandmarkEstimate> GaussianBank::landmark(std::size_t k) const {
  auto about = belief_of(population_.weights().heaviest()).landmark(k);
  if (!known_ || !about) return about;
  Mixture mixture(*about);
  for_beliefs(
      [&](double weight, const JointBelief& belief) { mixture.add(weight, *belief.landmark(k)); });
  return mixture.result();
}

/// Likewise; headings that were drawn after the scan are in it as they were drawn.
std::optional<JointEstimate> GaussianBank::joint(std::size_t landmarks) const {
  const JointBelief& heaviest = belief_of(population_.weights().heaviest());
  if (!known_ || active_.size() == 1) return heaviest.joint(landmarks);
  weigh_beliefs();
  Mixture mixture(heaviest.joint(landmarks));
  for_beliefs([&](double weight, const JointBelief& belief) {
    mixture.add(weight, belief.joint(landmarks));
  });
  return mixture.result();
}

}  // namespace montecarta::filters
