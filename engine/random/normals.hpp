// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"
#include "engine/numbers/real.hpp"
#include "engine/random/stream.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace montecarta::engine {

/// One 32-bit word in the low half of each 64-bit lane of a register; what the high halves hold
/// means nothing.
struct WordRegister {
  using Batch = register_math::BitsOf<register_math::Register>;
  Batch lanes;
};

/// The exact product lane by lane.
inline Halves<WordRegister> multiply_words(const WordRegister& a, std::uint32_t b) {
  const WordRegister::Batch product = register_math::multiply_low_halves(a.lanes, b);
  return {{product >> 32}, {product}};
}
inline WordRegister operator^(const WordRegister& a, const WordRegister& b) {
  return {a.lanes ^ b.lanes};
}
inline WordRegister operator^(const WordRegister& a, std::uint32_t b) {
  return {a.lanes ^ WordRegister::Batch(std::uint64_t{b})};
}

/// Two independent numbers for each lane.
template <class Real>
struct Pair {
  Real first, second;
};

/// Two standard normals out of two uniforms in (0, 1) (Box and Muller 1958).
template <class Real>
Pair<Real> box_muller(const Pair<Real>& uniform) {
  const Real radius = sqrt(-2.0 * log(uniform.first));
  const Direction<Real> angle = direction_of(kTwoPi * uniform.second);
  return {radius * angle.cosine, radius * angle.sine};
}

/// Uniforms 2 block and 2 block + 1 of the streams of indices identity.index, identity.index + 1,
/// ..., one for each lane: the same bits as RngStream(identity).uniform().
inline Pair<Lanes> uniform_pairs(const StreamIdentity& identity, std::uint32_t block,
                                 const Lanes& /*like*/) {
  using Batch = WordRegister::Batch;
  const auto same = [](std::uint64_t word) { return WordRegister{Batch(word)}; };
  const auto uniform = [](const WordRegister& low, const WordRegister& high) {
    const Batch low_half = low.lanes & Batch(std::uint64_t{0xffffffffU});
    const Batch bits = (low_half | (high.lanes << 32)) >> 12;
    return xsimd::bitwise_cast<Lanes::Register>(bits | Batch(std::uint64_t{0x3ff0000000000000U})) -
           Lanes::Register(1.0 - 0x1p-53);
  };
  const auto counted = []<std::uint64_t... l>(std::integer_sequence<std::uint64_t, l...>) {
    return Batch{l...};
  }
  (std::make_integer_sequence<std::uint64_t, Batch::size>());
  Pair<Lanes> pair{};
  for (std::size_t k = 0; k < Lanes::kRegisters; ++k) {
    const Batch index = Batch(std::uint64_t{identity.index} + k * Batch::size) + counted;
    const auto words = philox<WordRegister>(
        {WordRegister{index}, same(identity.step), same(identity.run),
         same(static_cast<std::uint32_t>(identity.purpose) << kPurposeShift | block)},
        {static_cast<std::uint32_t>(identity.seed),
         static_cast<std::uint32_t>(identity.seed >> 32)});
    pair.first.part[k] = uniform(words[0], words[1]);
    pair.second.part[k] = uniform(words[2], words[3]);
  }
  return pair;
}

inline Pair<double> uniform_pairs(const StreamIdentity& identity, std::uint32_t block,
                                  double /*like*/) {
  RngStream draw(identity, block);
  const double first = draw.uniform();
  return {first, draw.uniform()};
}

/// Normals 2 block and 2 block + 1 of the streams of `kLanesOf<Real>` consecutive indices.
template <class Real>
Pair<Real> normal_pairs(const StreamIdentity& identity, std::uint32_t block) {
  return box_muller(uniform_pairs(identity, block, Real()));
}
/// The same of consecutive streams, `kLanesOf<Real>` for each pair. In short loops the processor
/// computes several pairs at once, which else wait for their own bits most of the time.
template <class Real>
[[gnu::flatten]] inline void fill_normal_pairs(std::span<Pair<Real>> pairs, StreamIdentity identity,
                                               std::uint32_t block) {
  for (Pair<Real>& pair : pairs) {
    pair = uniform_pairs(identity, block, Real());
    identity.index += static_cast<std::uint32_t>(kLanesOf<Real>);
  }
  for (Pair<Real>& pair : pairs) pair = box_muller(pair);
}

/// The number that a standard normal variable stays below with `probability` in (0, 1).
double normal_quantile(double probability);

/// Share of a normal variable that lies farther than `deviations` standard deviations from its
/// mean, on either side.
double normal_tails(double deviations);

}  // namespace montecarta::engine
