// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::experiments {

/// A MATLAB file of level 5 contradicts itself; says how, for the reader of the file to say where.
class DamagedMat : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// How the numbers of an element are stored, or what else it is. [mat5] table 1-1.
enum class MatType : std::uint32_t {
  int8 = 1,
  uint8 = 2,
  int16 = 3,
  uint16 = 4,
  int32 = 5,
  uint32 = 6,
  float32 = 7,
  float64 = 9,
  int64 = 12,
  uint64 = 13,
  matrix = 14,
  compressed = 15
};

/// A piece of a MATLAB file: a type and its bytes, which stay where they were read.
struct MatElement {
  MatType type{};
  std::string_view bytes;
};

/// Takes the next element off `rest`. Throws DamagedMat where it does not lie wholly within.
MatElement take_element(std::string_view& rest);
/// The numbers of an element as doubles. Throws DamagedMat where it holds none.
std::vector<double> numbers_of(const MatElement& element);
/// Whether a variable with these array flags (8 bytes) is a full real array of numbers. [mat5]
/// table 1-3.
bool is_real_array(const MatElement& flags);
/// Inflates `packed` onto the end of `all`. Throws DamagedMat where it is broken, or where `all`
/// would grow beyond `most` bytes.
void inflate_onto(std::string& all, std::string_view packed, std::size_t most);

}  // namespace montecarta::experiments
