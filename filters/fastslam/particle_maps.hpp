// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/particles/genealogy.hpp"
#include "filters/moments/gaussians.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace montecarta::filters {

/// The maps of all particles. Landmarks are kept in slots; slot j of all particles is stored
/// together, in blocks. After resampling, a slot is rearranged only when it is next opened. `Held`
/// is the form in which a landmark is kept, a struct of Reals.
template <class Real, class Held = LandmarkGaussian<Real>>
class ParticleMaps {
 public:
  using Landmark = Held;

  explicit ParticleMaps(std::size_t particles)
      : blocks_(blocks_for<Real>(particles)), genealogy_(blocks_ * kLanesOf<Real>) {}

  void clear() {
    genealogy_.clear();
    n_slots_ = 0;
  }
  std::size_t slots() const { return n_slots_; }
  std::size_t blocks() const { return blocks_; }

  /// A slot that is read and written block by block, in any order or in parallel.
  class OpenSlot {
   public:
    /// Returns block b, rearranged to the present particles at the first visit of the scan.
    Landmark& fetch(std::size_t b) const {
      if (!source_.empty()) to_[b] = gather_block<Real, Landmark>(from_, source_, b);
      return to_[b];
    }
    /// Returns block b, which fetch() must have rearranged.
    Landmark& at(std::size_t b) const { return to_[b]; }

   private:
    friend class ParticleMaps;
    std::span<const Landmark> from_;
    std::span<std::uint32_t> source_;  ///< empty if the slot is up to date
    std::uint32_t since_ = 0;
    std::span<Landmark> to_;
  };

  /// Opens different slots for one scan. Every block of each must be fetched.
  void open(const StepContext& context, std::span<const std::uint32_t> slots,
            std::vector<OpenSlot>& opened) {
    opened.resize(slots.size());
    while (spares_.size() < slots.size()) spares_.emplace_back(blocks_);
    while (sources_.size() < slots.size()) sources_.emplace_back(blocks_ * kLanesOf<Real>);
    for (std::size_t k = 0; k < slots.size(); ++k) {
      Slot& slot = slots_[slots[k]];
      const bool is_current = slot.generation == genealogy_.generation();
      opened[k].since_ = slot.generation;
      if (!is_current) {
        std::swap(slot.blocks, spares_[k]);
        slot.generation = genealogy_.generation();
      }
      opened[k].from_ = spares_[k];
      opened[k].source_ = is_current ? std::span<std::uint32_t>() : sources_[k];
      opened[k].to_ = slot.blocks;
    }
    in_parts(context, [&](std::size_t first, std::size_t n) {
      for (const OpenSlot& slot : opened) {
        if (!slot.source_.empty()) trace(slot.since_, first, n, slot.source_);
      }
    });
  }

  /// Adds an empty slot for the caller to fill; returns its number.
  std::uint32_t add(const StepContext& context) {
    if (n_slots_ == slots_.size()) slots_.push_back({UntouchedColumn<Landmark>(blocks_), 0});
    slots_[n_slots_].generation = genealogy_.generation();
    const std::span<Landmark> blocks = slots_[n_slots_].blocks;
    in_parts(context, [&](std::size_t first, std::size_t n) {
      std::ranges::fill(blocks.subspan(first, n), Landmark{});
    });
    return static_cast<std::uint32_t>(n_slots_++);
  }
  /// Adds a slot with the same landmark for every particle; returns its number. Forms of landmarks
  /// other than a Gaussian have no known maps.
  std::uint32_t add(const StepContext& context, const LandmarkEstimate& known) {
    const std::uint32_t slot = add(context);
    if constexpr (std::is_same_v<Landmark, LandmarkGaussian<Real>>) {
      const auto& [mean, P] = known;
      std::ranges::fill(blocks_of(slot),
                        Landmark{{mean.x(), mean.y()}, {P(0, 0), P(0, 1), P(1, 1)}});
    } else {
      expect(false, "a known map in a form of landmarks that is no Gaussian");
    }
    return slot;
  }
  std::span<Landmark> blocks_of(std::uint32_t slot) { return slots_[slot].blocks; }

  /// Makes particle i a copy of particle parents[i], including lanes without a particle.
  void resample(const StepContext& context, std::span<const std::uint32_t> parents) {
    genealogy_.add(context, parents);
    if (!genealogy_.is_long()) return;
    for (std::size_t j = 0; j < n_slots_; ++j) bring_up_to_date(context, slots_[j]);
    genealogy_.forget();
  }

  /// The estimate of one particle of the landmark in slot j.
  LandmarkEstimate landmark_of(std::uint32_t j, std::uint32_t particle) const {
    const std::uint32_t then = genealogy_.trace(slots_[j].generation, particle);
    const auto& [mean, P] = gaussian_of(slots_[j].blocks[then / kLanesOf<Real>]);
    const std::size_t lane = then % kLanesOf<Real>;
    return {
        {get(mean.x, lane), get(mean.y, lane)},
        Eigen::Matrix2d{{get(P.xx, lane), get(P.xy, lane)}, {get(P.xy, lane), get(P.yy, lane)}}};
  }

  /// Copies slot j, in the order of the present particles, to `blocks`; the map is not changed.
  void copy_slot(const StepContext& context, std::uint32_t j, std::vector<std::uint32_t>& source,
                 std::vector<LandmarkGaussian<Real>>& blocks) const {
    source.resize(blocks_ * kLanesOf<Real>);
    blocks.resize(blocks_);
    const std::span<const Landmark> from = slots_[j].blocks;
    in_parts(context, [&](std::size_t first, std::size_t n) {
      trace(slots_[j].generation, first, n, source);
      for (std::size_t b = first; b < first + n; ++b)
        blocks[b] = gaussian_of(gather_block<Real, Landmark>(from, source, b));
    });
  }

 private:
  struct Slot {
    UntouchedColumn<Landmark> blocks;
    std::uint32_t generation = 0;  ///< number of resamplings that the blocks have followed
  };

  /// Calls body(first, n) for parts of n blocks, perhaps in parallel.
  template <class Body>
  void in_parts(const StepContext& context, const Body& body) const {
    BlockTasks<Real>(blocks_).run_together(context, body);
  }
  /// Writes the ancestors in generation `since` of the particles of n blocks.
  void trace(std::uint32_t since, std::size_t first, std::size_t n,
             std::span<std::uint32_t> source) const {
    constexpr std::size_t lanes = kLanesOf<Real>;
    genealogy_.trace(since, first * lanes, source.subspan(first * lanes, n * lanes));
  }
  void bring_up_to_date(const StepContext& context, Slot& slot) {
    if (spares_.empty()) spares_.emplace_back(blocks_);
    if (sources_.empty()) sources_.emplace_back(blocks_ * kLanesOf<Real>);
    const std::span<const Landmark> from = slot.blocks;
    in_parts(context, [&](std::size_t first, std::size_t n) {
      trace(slot.generation, first, n, sources_[0]);
      for (std::size_t b = first; b < first + n; ++b)
        spares_[0][b] = gather_block<Real, Landmark>(from, sources_[0], b);
    });
    std::swap(slot.blocks, spares_[0]);
    slot.generation = genealogy_.generation();
  }

  std::size_t blocks_;
  std::size_t n_slots_ = 0;
  Genealogy genealogy_;
  std::vector<Slot> slots_;
  std::vector<UntouchedColumn<Landmark>> spares_;
  std::vector<UntouchedColumn<std::uint32_t>> sources_;
};

}  // namespace montecarta::filters
