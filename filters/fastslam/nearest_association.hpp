// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/errors.hpp"
#include "filters/association/pairing.hpp"
#include "filters/fastslam/concepts.hpp"
#include "filters/fastslam/sensor_policy.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace montecarta::filters {

/// Every particle associates detections with the landmarks of its own map (EQUATIONS 17), with the
/// covariance of its predicted pose in the innovation. Particle i owns the slots 0 to count(i) - 1.
template <class Real, class SensorPolicy = SensorAtPose, class Held = LandmarkGaussian<Real>>
class NearestAssociation {
 public:
  using Maps = ParticleMaps<Real, Held>;
  NearestAssociation(std::size_t particles, const AssociationSettings& settings,
                     const Belief& belief)
      : particles_(particles),
        settings_(settings),
        sensor_policy_(belief.sensor),
        noise_(SensorNoise::of(belief)),
        log_new_density_(log_new_density(settings, belief)),
        counts_(blocks_for<Real>(particles), Real(0.0)),
        resampled_counts_(counts_),
        made_of_(particles) {}

  void start() {
    std::fill(counts_.begin(), counts_.end(), Real(0.0));
    made_of_.clear();
  }
  /// Gives every particle the landmarks of a known map, {identity}.
  void add_known(const StepContext& context, std::span<const LandmarkEstimate> map, Maps& maps) {
    for (const LandmarkEstimate& known : map) {
      const auto identity = static_cast<std::int32_t>(maps.add(context, known));
      for (std::size_t i = 0; i < particles_; ++i) made_of_.add(i, identity);
    }
    std::ranges::fill(counts_, Real(static_cast<double>(map.size())));
  }

  /// Associates every detection by the map of every particle.
  void associate(const StepContext& context, Scan scan, Maps& maps,
                 const std::vector<PoseGaussian<Real>>& predicted) {
    scan_ = scan;
    seen_.clear();
    for (const Detection& detection : scan) seen_.push_back(measurement_of<Real>(detection));
    slots_.resize(maps.slots());
    std::iota(slots_.begin(), slots_.end(), 0U);
    maps.open(context, slots_, opened_);
    pairings_.resize(maps.blocks() * kLanes * seen_.size());
    searches_.resize(pairings_.size());
    context.parallel_for(
        maps.blocks(), [&](std::size_t b) { judge_block(b, sensor_policy_.sensor(predicted[b])); });
  }

  bool matched_nothing() const {
    for (std::size_t i = 0; i < particles_; ++i) {
      for (const Pairing& pairing : pairings_of(i)) {
        if (pairing.kind != PairingKind::ignored) return false;
      }
    }
    return true;
  }
  std::size_t matches() const { return seen_.size(); }
  /// The weight of the particles that matched detection k.
  double matched_weight(std::size_t k, const Weights<Real>& weights) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < particles_; ++i) {
      if (pairings_of(i)[k].kind == PairingKind::matched) sum += weights.linear_scalars()[i];
    }
    return sum;
  }

  /// Does nothing, since associate() has fetched all blocks.
  void fetch(std::size_t /*b*/) const {}
  using Matched = Match<Real, Held, decltype(Real() > Real())>;
  Matched match(std::size_t b, std::size_t k) const {
    return {collect(b, k), seen_[k], matched(b, k) > Real(0.5)};
  }
  void store(std::size_t b, std::size_t k, const Matched& changed) const {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Pairing& pairing = pairings_of(b * kLanes + lane)[k];
      if (pairing.kind == PairingKind::matched)
        copy_lane<Real>(changed.landmark, opened_[pairing.landmark].at(b), lane);
    }
  }
  /// log p0 for every detection that a particle has not matched, so that all weights have the same
  /// number of factors.
  Real unmatched_log_weight(std::size_t b) const {
    Real sum(0.0);
    for (std::size_t k = 0; k < seen_.size(); ++k) sum += log_new_density_ * (1.0 - matched(b, k));
    return sum;
  }

  /// Association errors by the simulator's identities; to be called before new_landmarks().
  AssociationCounts counts(const Weights<Real>& weights) const {
    AssociationCounts mean;
    for (std::size_t i = 0; i < particles_; ++i) {
      add(association_counts(scan_, pairings_of(i), made_of_.of(i)), weights.linear_scalars()[i],
          mean);
    }
    return mean;
  }

  /// Number of landmarks of a map, averaged over the weighted particles.
  double map_size(const Maps& /*maps*/, const Weights<Real>& weights) const {
    double mean = 0.0;
    for (std::size_t i = 0; i < particles_; ++i) {
      mean += weights.linear_scalars()[i] * static_cast<double>(count_of(i));
    }
    return mean;
  }

  /// Gives every particle its own slot for each detection that is new to it.
  const std::vector<FreshLandmark<Real>>& new_landmarks(const StepContext& context, Maps& maps) {
    fresh_.clear();
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      for (std::size_t i = 0; i < particles_; ++i) {
        if (pairings_of(i)[k].kind == PairingKind::fresh) add_slot(context, scan_[k], i, maps);
      }
    }
    return fresh_;
  }
  void resample(const StepContext& context, std::span<const std::uint32_t> parents) {
    gather<Real>(context, counts_, parents, resampled_counts_);
    std::swap(counts_, resampled_counts_);
    made_of_.resample(parents);
  }
  /// The j-th landmark of the heaviest particle. There is no mixture: particles do not share slots.
  std::optional<LandmarkEstimate> landmark(const StepContext& /*context*/, std::size_t j,
                                           const Maps& maps, const Weights<Real>& weights) const {
    const std::size_t heaviest = weights.heaviest();
    if (j >= count_of(heaviest)) return std::nullopt;
    return maps.landmark_of(static_cast<std::uint32_t>(j), static_cast<std::uint32_t>(heaviest));
  }

 private:
  static constexpr std::size_t kLanes = kLanesOf<Real>;

  std::span<Pairing> pairings_of(std::size_t particle) {
    return std::span(pairings_).subspan(particle * seen_.size(), seen_.size());
  }
  std::span<const Pairing> pairings_of(std::size_t particle) const {
    return std::span(pairings_).subspan(particle * seen_.size(), seen_.size());
  }

  void judge_block(std::size_t b, const PoseGaussian<Real>& pose) {
    const std::span<NearestSearch> searches =
        std::span(searches_).subspan(b * kLanes * seen_.size(), kLanes * seen_.size());
    std::ranges::fill(searches, NearestSearch{});
    for (std::uint32_t j = 0; j < opened_.size(); ++j)
      offer(b, j, gaussian_of(opened_[j].fetch(b)), pose, searches);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::span<Pairing> pairings = pairings_of(b * kLanes + lane);
      for (std::size_t k = 0; k < seen_.size(); ++k) {
        pairings[k] = decide_pairing(searches[k * kLanes + lane], settings_);
      }
      exclude_rivals(pairings);
    }
  }

  /// Offers landmark j to every detection of the scan from the pose of the sensor; `searches`
  /// {detection, lane}.
  void offer(std::size_t b, std::uint32_t j, const LandmarkGaussian<Real>& landmark,
             const PoseGaussian<Real>& pose, std::span<NearestSearch> searches) const {
    const auto s = sight(typename SensorPolicy::Kind(), pose.mean, landmark.mean);
    const auto owned = Real(static_cast<double>(j)) < counts_[b];
    const Real never(std::numeric_limits<double>::infinity());
    // Only the innovation itself differs between detections, and most detections are far away.
    const Symmetric2<Real> S = innovation_of(pose.covariance, s, {}, landmark.covariance, noise_).S;
    const Real determinant = S.determinant();
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      const Measurement<Real> v = residual(seen_[k], s);
      const Real distance = select(owned, S.adjugate_form(v.first, v.second) / determinant, never);
      if (!any(distance < Real(settings_.new_gate))) continue;
      const Real cost = distance + log(determinant);
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        searches[k * kLanes + lane].offer(j, get(distance, lane), get(cost, lane), settings_.gate);
      }
    }
  }

  /// 1 for the lanes that matched detection k, else 0.
  Real matched(std::size_t b, std::size_t k) const {
    Real flags(0.0);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (pairings_of(b * kLanes + lane)[k].kind == PairingKind::matched) set(flags, lane, 1.0);
    }
    return flags;
  }

  /// The landmark that each lane matched with detection k; a default one in lanes without a match.
  Held collect(std::size_t b, std::size_t k) const {
    Held landmark{};
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Pairing& pairing = pairings_of(b * kLanes + lane)[k];
      if (pairing.kind == PairingKind::matched)
        copy_lane<Real>(opened_[pairing.landmark].at(b), landmark, lane);
    }
    return landmark;
  }

  /// Number of landmarks of a particle.
  std::size_t count_of(std::size_t particle) const {
    return static_cast<std::size_t>(get(counts_[particle / kLanes], particle % kLanes));
  }
  void add_slot(const StepContext& context, const Detection& detection, std::size_t particle,
                Maps& maps) {
    const auto slot = static_cast<std::uint32_t>(count_of(particle));
    if (slot >= settings_.most_landmarks) {
      throw std::runtime_error("the map of a particle grew beyond " +
                               std::to_string(settings_.most_landmarks) + " landmarks");
    }
    if (slot == maps.slots()) maps.add(context);
    set(counts_[particle / kLanes], particle % kLanes, slot + 1.0);
    made_of_.add(particle, detection.identity);
    fresh_.push_back({detection, particle / kLanes, slot, particle % kLanes});
  }

  std::size_t particles_;
  AssociationSettings settings_;
  SensorPolicy sensor_policy_;
  SensorNoise noise_;
  double log_new_density_;
  std::vector<Real> counts_, resampled_counts_;
  InitialisationIdentities made_of_;
  Scan scan_;  ///< valid during update() only
  std::vector<Measurement<Real>> seen_;
  std::vector<std::uint32_t> slots_;
  std::vector<Pairing> pairings_;        ///< {particle, detection} results of the last scan
  std::vector<NearestSearch> searches_;  ///< {block, detection, lane} searches of the last scan
  std::vector<typename Maps::OpenSlot> opened_;
  std::vector<FreshLandmark<Real>> fresh_;
};

}  // namespace montecarta::filters
