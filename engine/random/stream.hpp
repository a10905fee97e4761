// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"
#include "engine/numbers/real.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace montecarta::engine {

/// The two halves of a product of 32-bit numbers.
template <class Word>
struct Halves {
  Word high, low;
};

/// a times b, for a word in 64 bits.
inline Halves<std::uint64_t> multiply_words(std::uint64_t a, std::uint32_t b) {
  const std::uint64_t product = a * b;
  return {product >> 32, product & 0xffffffffU};
}

/// Philox4x32-10 (Salmon, Moraes, Dror and Shaw, SC 2011): ten rounds turn a counter and a key into
/// four random words. `Word` holds one 32-bit number in 64 bits; it is std::uint64_t, or has one
/// such number for each lane.
template <class Word>
std::array<Word, 4> philox(std::array<Word, 4> counter, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const Halves<Word> a = multiply_words(counter[0], 0xD2511F53U);
    const Halves<Word> b = multiply_words(counter[2], 0xCD9E8D57U);
    counter = {b.high ^ counter[1] ^ key[0], b.low, a.high ^ counter[3] ^ key[1], a.low};
    key[0] += 0x9E3779B9U;
    key[1] += 0xBB67AE85U;
  }
  return counter;
}

/// A counter consists of index, step, run, and purpose together with the number of the block.
inline constexpr int kPurposeShift = 24;
inline constexpr std::uint32_t kBlockMask = 0xffffffU;

/// The purpose of a draw. Two places never share one, and those of the world never depend on the
/// filter. The numbers are part of every result: append, never renumber. 25 and 26 are taken.
enum class Draw : std::uint8_t {
  world_control = 0,     ///< noise on the control (measured-control) or on the motion (matched)
  world_detection = 1,   ///< noise on range and bearing, index = landmark
  world_miss = 2,        ///< misses of detections, index = landmark
  world_clutter = 3,     ///< number and position of false alarms
  world_landmark = 4,    ///< displacement of landmarks in random maps
  world_start = 5,       ///< error of the start that a filter is given
  world_survey = 6,      ///< error of a known landmark that a filter is given, index = landmark
  world_fix = 7,         ///< noise of a fix of the position
  world_increment = 8,   ///< noise of a step, besides that of its control
  motion_sample = 16,    ///< motion noise of FastSLAM I, index = particle
  pose_proposal = 17,    ///< draw from the proposal, index = particle
  resampling = 18,       ///< index = 0 (systematic) or particle
  evolution = 19,        ///< differential evolution
  kernel_sample = 23,    ///< marginal filters: draw from the chosen kernel, index = particle
  external_filter = 28,  ///< seed of the generator of a program outside the process
  start_sample = 29,     ///< pose at the start, drawn from its prior, index = particle
  analysis_bootstrap = 32,
  analysis_thinning = 33,  ///< which of the weighted particles stay as draws of equal weight
  test = 255,
};

/// The identity of a stream of random numbers.
struct StreamIdentity {
  std::uint64_t seed = 0;  ///< seed of the study
  std::uint64_t run = 0;   ///< number of the run, below 2^32
  std::uint32_t step = 0;
  std::uint32_t index = 0;  ///< index of the particle, landmark, ...
  Draw purpose = Draw::test;
};

/// A stream of random numbers that is a pure function of its identity (Philox4x32-10).
class RngStream {
 public:
  /// Starts at number 2 `block` of the stream; block < 2^24.
  explicit RngStream(const StreamIdentity& identity, std::uint32_t block = 0);

  /// Draws 64 uniform bits.
  std::uint64_t bits();
  /// Draws a uniform number in (0, 1) with 52 bits, never 0 or 1.
  double uniform();
  /// Draws a uniform number in {0, ..., count - 1}, without bias; count >= 1.
  std::uint32_t below(std::uint32_t count);
  /// Draws a standard normal number (Box-Muller; both numbers of a pair are used, in order).
  double normal();

 private:
  std::array<std::uint32_t, 2> key_;
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint64_t, 2> block_{};
  int left_ = 0;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

/// One 32-bit word in the low half of each 64-bit lane of a register; the high halves are
/// undefined.
struct WordRegister {
  using Batch = register_math::BitsOf<register_math::Register>;
  Batch lanes;
};

/// The exact product, lane by lane.
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

/// Two standard normals from two uniform numbers in (0, 1) (Box and Muller 1958).
template <class Real>
Pair<Real> box_muller(const Pair<Real>& uniform) {
  const Real radius = sqrt(-2.0 * log(uniform.first));
  const Direction<Real> angle = direction_of(kTwoPi * uniform.second);
  return {radius * angle.cosine, radius * angle.sine};
}

/// Uniforms 2 block and 2 block + 1 of the streams with indices identity.index, identity.index + 1,
/// ..., one for each lane, with the same bits as RngStream(identity).uniform().
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

/// Normals 2 block and 2 block + 1 of the streams with `kLanesOf<Real>` consecutive indices.
template <class Real>
Pair<Real> normal_pairs(const StreamIdentity& identity, std::uint32_t block) {
  return box_muller(uniform_pairs(identity, block, Real()));
}
/// Normal pairs for consecutive streams, `kLanesOf<Real>` for each pair. In short loops the
/// processor computes several pairs at once, which would otherwise wait for each other's bits.
template <class Real>
[[gnu::flatten]] inline void fill_normal_pairs(std::span<Pair<Real>> pairs, StreamIdentity identity,
                                               std::uint32_t block) {
  for (Pair<Real>& pair : pairs) {
    pair = uniform_pairs(identity, block, Real());
    identity.index += static_cast<std::uint32_t>(kLanesOf<Real>);
  }
  for (Pair<Real>& pair : pairs) pair = box_muller(pair);
}

/// Probability that a normal variable deviates from its mean by more than `deviations` standard
/// deviations, on either side.
double normal_tails(double deviations);

}  // namespace montecarta::engine
