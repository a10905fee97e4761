// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/mat_elements.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <zlib.h>

namespace montecarta::experiments {
namespace {

template <class Number>
Number number_at(std::string_view bytes, std::size_t offset) {
  Number value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

template <class Number>
std::vector<double> as_doubles(std::string_view bytes) {
  if (bytes.size() % sizeof(Number) != 0) throw DamagedMat("a number is cut short");
  std::vector<double> values(bytes.size() / sizeof(Number));
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<double>(number_at<Number>(bytes, i * sizeof(Number)));
  }
  return values;
}

/// Up to four bytes stand in the tag itself, with their count where others have zero.
MatElement take_small(std::string_view& rest, std::uint32_t word) {
  const std::uint32_t count = word >> 16U;
  if (count > 4) throw DamagedMat("a small element has more than four bytes");
  const MatElement element{static_cast<MatType>(word & 0xffffU), rest.substr(4, count)};
  rest.remove_prefix(8);
  return element;
}

struct EndInflation {
  void operator()(z_stream* stream) const { inflateEnd(stream); }
};

}  // namespace

MatElement take_element(std::string_view& rest) {
  if (rest.size() < 8) throw DamagedMat("it ends too early");
  const auto word = number_at<std::uint32_t>(rest, 0);
  if (word >> 16U != 0) return take_small(rest, word);
  const std::size_t count = number_at<std::uint32_t>(rest, 4);
  const auto type = static_cast<MatType>(word);
  if (count > rest.size() - 8) throw DamagedMat("it ends too early");
  const MatElement element{type, rest.substr(8, count)};
  // Everything begins at a multiple of eight bytes, but for what follows compressed elements.
  const std::size_t padded = type == MatType::compressed ? count : (count + 7) / 8 * 8;
  rest.remove_prefix(std::min(8 + padded, rest.size()));
  return element;
}

std::vector<double> numbers_of(const MatElement& element) {
  switch (element.type) {
    case MatType::int8:
      return as_doubles<std::int8_t>(element.bytes);
    case MatType::uint8:
      return as_doubles<std::uint8_t>(element.bytes);
    case MatType::int16:
      return as_doubles<std::int16_t>(element.bytes);
    case MatType::uint16:
      return as_doubles<std::uint16_t>(element.bytes);
    case MatType::int32:
      return as_doubles<std::int32_t>(element.bytes);
    case MatType::uint32:
      return as_doubles<std::uint32_t>(element.bytes);
    case MatType::float32:
      return as_doubles<float>(element.bytes);
    case MatType::float64:
      return as_doubles<double>(element.bytes);
    case MatType::int64:
      return as_doubles<std::int64_t>(element.bytes);
    case MatType::uint64:
      return as_doubles<std::uint64_t>(element.bytes);
    default:
      throw DamagedMat("an element holds no numbers");
  }
}

bool is_real_array(const MatElement& flags) {
  constexpr unsigned kDouble = 6, kUint64 = 15, kComplexFlag = 8;
  const auto kind = number_at<std::uint8_t>(flags.bytes, 0);
  const auto bits = number_at<std::uint8_t>(flags.bytes, 1);
  return kind >= kDouble && kind <= kUint64 && (bits & kComplexFlag) == 0;
}

void inflate_onto(std::string& all, std::string_view packed, std::size_t most) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) throw DamagedMat("zlib does not start");
  const std::unique_ptr<z_stream, EndInflation> end(&stream);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  std::array<char, 1U << 14U> chunk;
  for (int status = Z_OK; status != Z_STREAM_END;) {
    stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
    stream.avail_out = static_cast<uInt>(chunk.size());
    status = inflate(&stream, Z_NO_FLUSH);
    if (status != Z_OK && status != Z_STREAM_END) throw DamagedMat("its compression is broken");
    all.append(chunk.data(), chunk.size() - stream.avail_out);
    if (all.size() > most) throw DamagedMat("it is larger than anything here");
  }
}

}  // namespace montecarta::experiments
