// SPDX-License-Identifier: BSD-3-Clause
#include "engine/random/stream.hpp"

#include "engine/errors.hpp"

#include <boost/math/special_functions/erf.hpp>

#include <bit>
#include <numbers>

namespace montecarta::engine {

RngStream::RngStream(const StreamIdentity& identity, std::uint32_t block)
    : key_{static_cast<std::uint32_t>(identity.seed),
           static_cast<std::uint32_t>(identity.seed >> 32)},
      counter_{identity.index, identity.step, static_cast<std::uint32_t>(identity.run),
               static_cast<std::uint32_t>(identity.purpose) << kPurposeShift | block} {
  expect(identity.run <= 0xffffffffU, "a run number needs more than 32 bits");
}

std::uint64_t RngStream::bits() {
  if (left_ == 0) {
    const auto words =
        philox<std::uint64_t>({counter_[0], counter_[1], counter_[2], counter_[3]}, key_);
    block_ = {words[0] | (words[1] << 32), words[2] | (words[3] << 32)};
    left_ = 2;
    counter_[3] = (counter_[3] & ~kBlockMask) | ((counter_[3] + 1) & kBlockMask);
    expect((counter_[3] & kBlockMask) != 0, "a random stream ran out of numbers");
  }
  return block_[static_cast<std::size_t>(2 - left_--)];
}

double RngStream::uniform() {
  const double in_one_two = std::bit_cast<double>((bits() >> 12) | 0x3ff0000000000000U);
  return in_one_two - (1.0 - 0x1p-53);
}

std::uint32_t RngStream::below(std::uint32_t count) {
  // Lemire's method: the number is drawn again in the biased tail of the product, which is shorter
  // than `count`, so that its length is hardly ever needed.
  for (;;) {
    const std::uint64_t product = (bits() >> 32) * count;
    const auto low = static_cast<std::uint32_t>(product);
    if (low >= count || low >= (0U - count) % count)
      return static_cast<std::uint32_t>(product >> 32);
  }
}

double RngStream::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double first = uniform();
  const auto [normal, spare] = box_muller<double>({first, uniform()});
  spare_ = spare;
  has_spare_ = true;
  return normal;
}

double normal_tails(double deviations) {
  return boost::math::erfc(deviations / std::numbers::sqrt2);
}

}  // namespace montecarta::engine
