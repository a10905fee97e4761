// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/step_context.hpp"
#include "engine/errors.hpp"
#include "engine/particles/weights.hpp"
#include "filters/association/association_counts.hpp"
#include "filters/association/birth_identities.hpp"
#include "filters/association/nearest.hpp"
#include "filters/fastslam/particle_maps.hpp"
#include "filters/moments/correlated_map.hpp"
#include "filters/moments/linearised.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace montecarta {

/// Every particle decides for itself which landmark of its own map a detection is (SPEC 17), with
/// the covariance of its predicted pose in the innovation. Particle i owns slots 0 to count(i) - 1.
template <class Real>
class NearestAssociation {
 public:
  NearestAssociation(std::size_t particles, const AssociationSettings& settings,
                     const Belief& belief)
      : particles_(particles),
        settings_(settings),
        log_new_density_(log_new_density(settings, belief)),
        counts_(blocks_for<Real>(particles), Real(0.0)),
        resampled_counts_(counts_),
        made_of_(particles) {}

  void clear() {
    std::fill(counts_.begin(), counts_.end(), Real(0.0));
    made_of_.clear();
  }

  /// Judges every detection by every particle's map; predicted(b) is the pose Gaussian of block b,
  /// expected(b, slot, pose, landmark, sightline) the covariance of what should be seen.
  template <class Predicted, class Expected>
  void associate(const StepContext& context, Scan scan, ParticleMaps<Real>& maps,
                 const Predicted& predicted, const Expected& expected) {
    scan_ = scan;
    seen_.clear();
    for (const Detection& detection : scan) seen_.push_back(sight_of<Real>(detection));
    slots_.resize(maps.slots());
    std::iota(slots_.begin(), slots_.end(), 0U);
    maps.open(slots_, opened_);
    pairings_.resize(maps.blocks() * kLanes * seen_.size());
    searches_.resize(pairings_.size());
    context.parallel_for(maps.blocks(),
                         [&](std::size_t b) { judge_block(b, predicted(b), expected); });
  }

  bool found_nothing() const {
    for (std::size_t i = 0; i < particles_; ++i) {
      for (const Pairing& pairing : pairings_of(i)) {
        if (pairing.verdict != Verdict::ignored) return false;
      }
    }
    return true;
  }
  std::size_t matches() const { return seen_.size(); }
  /// The weight of the particles that matched detection k.
  double matched_weight(std::size_t k, const Weights<Real>& weights) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < particles_; ++i) {
      if (pairings_of(i)[k].verdict == Verdict::matched) sum += weights.linear_scalars()[i];
    }
    return sum;
  }

  template <class Visit>
  void read(std::size_t b, const Visit& visit) const {
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      visit(k, collect(b, k), seen_[k], matched(b, k) > Real(0.5));
    }
  }
  template <class Visit>
  void update(std::size_t b, const Visit& visit) const {
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      LandmarkGaussian<Real> landmark = collect(b, k);
      visit(k, landmark, seen_[k], matched(b, k) > Real(0.5));
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const Pairing& pairing = pairings_of(b * kLanes + lane)[k];
        if (pairing.verdict == Verdict::matched)
          copy_lane<Real>(landmark, opened_[pairing.landmark].at(b), lane);
      }
    }
  }
  /// visit(slot) for the landmarks of all matches, each perhaps many times.
  template <class Visit>
  void each_slot(const Visit& visit) const {
    for (const Pairing& pairing : pairings_) {
      if (pairing.verdict == Verdict::matched) visit(pairing.landmark);
    }
  }
  /// Block b of any slot.
  const LandmarkGaussian<Real>& landmark_in(std::uint32_t slot, std::size_t b) const {
    return opened_[slot].at(b);
  }
  /// Which landmark of a correlated map each lane takes detection k for; index_of(slot) says where
  /// that holds a slot. A lane without a match gets a harmless one.
  template <class IndexOf>
  ForEach<Real> where(std::size_t b, std::size_t k, const IndexOf& index_of) const {
    ForEach<Real> at{};
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Pairing& pairing = pairings_of(b * kLanes + lane)[k];
      if (pairing.verdict == Verdict::matched) {
        at.index[lane] = static_cast<std::uint32_t>(index_of(pairing.landmark));
      }
    }
    return at;
  }
  /// log p0 for every detection that a particle cannot explain, so that all weigh by as many
  /// factors.
  Real unmatched_log_weight(std::size_t b) const {
    Real sum(0.0);
    for (std::size_t k = 0; k < seen_.size(); ++k) sum += log_new_density_ * (1.0 - matched(b, k));
    return sum;
  }

  /// Against the simulator's identities; before add_new().
  AssociationCounts counts(const Weights<Real>& weights) const {
    AssociationCounts mean;
    for (std::size_t i = 0; i < particles_; ++i) {
      add(association_counts(scan_, pairings_of(i), made_of_.of(i)), weights.linear_scalars()[i],
          mean);
    }
    return mean;
  }

  /// Landmarks of a map, mean over the weighted particles.
  double map_size(const ParticleMaps<Real>& /*maps*/, const Weights<Real>& weights) const {
    double mean = 0.0;
    for (std::size_t i = 0; i < particles_; ++i) {
      mean += weights.linear_scalars()[i] * static_cast<double>(count_of(i));
    }
    return mean;
  }

  /// Adds birth(block, seen) to the maps that have it new; then settled(block, slot, put), where
  /// put(from, to) copies the one lane that has that slot for it.
  template <class Birth, class Settled>
  void add_new(ParticleMaps<Real>& maps, const Birth& birth, const Settled& settled) {
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      for (std::size_t b = 0; b < maps.blocks(); ++b) add_to_block(maps, b, k, birth, settled);
    }
  }
  void resample(std::span<const std::uint32_t> parents) {
    gather<Real>(counts_, parents, resampled_counts_);
    std::swap(counts_, resampled_counts_);
    made_of_.resample(parents);
  }
  /// Slots are given out by every particle for itself, so only one particle's map makes sense.
  static constexpr bool kShared = false;
  /// How many landmarks a particle has.
  std::size_t count_of(std::size_t particle) const {
    return static_cast<std::size_t>(get(counts_[particle / kLanes], particle % kLanes));
  }

 private:
  static constexpr std::size_t kLanes = kLanesOf<Real>;

  std::span<Pairing> pairings_of(std::size_t particle) {
    return std::span(pairings_).subspan(particle * seen_.size(), seen_.size());
  }
  std::span<const Pairing> pairings_of(std::size_t particle) const {
    return std::span(pairings_).subspan(particle * seen_.size(), seen_.size());
  }

  template <class Expected>
  void judge_block(std::size_t b, const PoseGaussian<Real>& pose, const Expected& expected) {
    const std::span<NearestSearch> searches =
        std::span(searches_).subspan(b * kLanes * seen_.size(), kLanes * seen_.size());
    std::ranges::fill(searches, NearestSearch{});
    for (std::size_t j = 0; j < opened_.size(); ++j)
      offer(b, j, opened_[j].fetch(b), pose, expected, searches);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::span<Pairing> pairings = pairings_of(b * kLanes + lane);
      for (std::size_t k = 0; k < seen_.size(); ++k) {
        pairings[k] = judge(searches[k * kLanes + lane], settings_);
      }
      exclude_rivals(pairings);
    }
  }

  /// Offers landmark j to every detection of the scan; `searches` {detection, lane}.
  template <class Expected>
  void offer(std::size_t b, std::size_t j, const LandmarkGaussian<Real>& landmark,
             const PoseGaussian<Real>& pose, const Expected& expected,
             std::span<NearestSearch> searches) const {
    const Sightline<Real> s = sightline(pose.mean, landmark.mean);
    const auto owned = Real(static_cast<double>(j)) < counts_[b];
    const Real never(std::numeric_limits<double>::infinity());
    // Only the innovation itself differs from detection to detection; most lie far away.
    const Innovation<Real> spread = expected(b, static_cast<std::uint32_t>(j), pose, landmark, s);
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      const Real distance = select(owned, spread.squared(residual(seen_[k], s)), never);
      if (!any(distance < Real(settings_.new_gate))) continue;
      const Real cost = distance + log(spread.S.determinant());
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        searches[k * kLanes + lane].offer(static_cast<std::uint32_t>(j), get(distance, lane),
                                          get(cost, lane), settings_.gate);
      }
    }
  }

  /// 1 for the lanes that matched detection k, else 0.
  Real matched(std::size_t b, std::size_t k) const {
    Real flags(0.0);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (pairings_of(b * kLanes + lane)[k].verdict == Verdict::matched) set(flags, lane, 1.0);
    }
    return flags;
  }

  /// The landmark each lane matched with detection k; a lane without a match gets a harmless one.
  LandmarkGaussian<Real> collect(std::size_t b, std::size_t k) const {
    LandmarkGaussian<Real> landmark{};
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Pairing& pairing = pairings_of(b * kLanes + lane)[k];
      if (pairing.verdict == Verdict::matched)
        copy_lane<Real>(opened_[pairing.landmark].at(b), landmark, lane);
    }
    return landmark;
  }

  template <class Birth, class Settled>
  void add_to_block(ParticleMaps<Real>& maps, std::size_t b, std::size_t k, const Birth& birth,
                    const Settled& settled) {
    const LandmarkGaussian<Real> born = birth(b, seen_[k]);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t particle = b * kLanes + lane;
      if (particle >= particles_ || pairings_of(particle)[k].verdict != Verdict::fresh) continue;
      const auto slot = static_cast<std::uint32_t>(get(counts_[b], lane));
      if (slot >= settings_.most_landmarks) {
        throw RunError("the map of a particle grew beyond " +
                       std::to_string(settings_.most_landmarks) + " landmarks");
      }
      if (slot == maps.slots()) maps.add();
      copy_lane<Real>(born, maps.blocks_of(slot)[b], lane);
      set(counts_[b], lane, slot + 1.0);
      made_of_.add(particle, scan_[k].identity);
      settled(b, slot, [lane](const auto& from, auto& to) { copy_lane<Real>(from, to, lane); });
    }
  }

  std::size_t particles_;
  AssociationSettings settings_;
  double log_new_density_;
  std::vector<Real> counts_, resampled_counts_;
  BirthIdentities made_of_;
  Scan scan_;  ///< the caller's, for the time of an update
  std::vector<RangeBearing<Real>> seen_;
  std::vector<std::uint32_t> slots_;
  std::vector<Pairing> pairings_;        ///< {particle, detection}
  std::vector<NearestSearch> searches_;  ///< {block, detection, lane}
  std::vector<typename ParticleMaps<Real>::OpenSlot> opened_;
};

}  // namespace montecarta
