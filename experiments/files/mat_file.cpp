// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/mat_file.hpp"

#include "engine/errors.hpp"
#include "experiments/files/files.hpp"
#include "experiments/files/mat_elements.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <string_view>

namespace montecarta::experiments {
namespace {

constexpr std::size_t kHeaderBytes = 128;
/// Ten times the largest file of the published drives; as doubles eight times as much at the worst.
constexpr std::size_t kMostBytes = std::size_t{64} << 20U;

void check_header(const std::string& bytes, const std::string& place) {
  const std::string_view mark = std::string_view(bytes).substr(0, kHeaderBytes);
  if (mark.starts_with("\x89HDF") || mark.starts_with("MATLAB 7.3")) {
    throw StudyError(place + ": a MATLAB 7.3 file (which is HDF5): save it with -v7");
  }
  if (mark.size() < kHeaderBytes || mark.substr(124) != std::string_view("\x00\x01IM", 4)) {
    throw StudyError(place + ": cannot be read (no little-endian MATLAB file of level 5): " +
                     "check the path, or save it with -v7");
  }
}

void expect_element(bool condition, const char* fault) {
  if (!condition) throw DamagedMat(fault);
}

/// All variables one after the other, nothing compressed.
std::string inflated(std::string_view rest) {
  std::string all;
  while (!rest.empty()) {
    const std::string_view whole = rest;
    const MatElement element = take_element(rest);
    if (element.type == MatType::compressed) {
      inflate_onto(all, element.bytes, kMostBytes);
    } else {
      all += whole.substr(0, whole.size() - rest.size());
    }
    expect_element(all.size() <= kMostBytes, "there are more than 64 MiB of variables");
    all.resize((all.size() + 7) / 8 * 8);
  }
  return all;
}

Eigen::MatrixXd matrix_of(const std::vector<double>& sides, const MatElement& numbers) {
  constexpr double kLongestSide = 1U << 31U;
  const auto is_side = [](double side) { return side >= 0 && side <= kLongestSide; };
  expect_element(std::ranges::all_of(sides, is_side), "a matrix has an impossible size");
  const std::vector<double> values = numbers_of(numbers);
  expect_element(sides[0] * sides[1] == static_cast<double>(values.size()),
                 "a matrix has other sides than numbers");
  return Eigen::Map<const Eigen::MatrixXd>(values.data(), static_cast<Eigen::Index>(sides[0]),
                                           static_cast<Eigen::Index>(sides[1]));
}

/// Flags, sides, name, real part; whatever is no real two-dimensional array of numbers is left out.
void read_variable(std::string_view body, std::map<std::string, Eigen::MatrixXd>& matrices) {
  const MatElement flags = take_element(body);
  expect_element(flags.bytes.size() == 8, "a variable has no flags");
  if (!is_real_array(flags)) return;
  const std::vector<double> sides = numbers_of(take_element(body));
  const std::string name(take_element(body).bytes);
  if (sides.size() == 2) matrices.insert_or_assign(name, matrix_of(sides, take_element(body)));
}

}  // namespace

MatFile::MatFile(const std::filesystem::path& path) : place_(path.string()) {
  const std::string bytes = whole_file(path);
  check_header(bytes, place_);
  try {
    const std::string all = inflated(std::string_view(bytes).substr(kHeaderBytes));
    for (std::string_view rest = all; !rest.empty();) {
      const MatElement element = take_element(rest);
      if (element.type == MatType::matrix) read_variable(element.bytes, matrices_);
    }
  } catch (const DamagedMat& fault) {
    throw StudyError(place_ + ": damaged (variable " + std::to_string(matrices_.size() + 1) + ": " +
                     fault.what() + "): copy or save it again");
  }
}

const Eigen::MatrixXd& MatFile::matrix(const std::string& name) const {
  if (const auto found = matrices_.find(name); found != matrices_.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, matrix] : matrices_) names.push_back(excerpt(known));
  throw StudyError(place_ + ": no variable '" + name + "' (a real matrix of numbers; there are: " +
                   excerpt(joined(names)) + "): save it under that name");
}

std::vector<double> MatFile::series(const std::string& name) const {
  const Eigen::MatrixXd& values = matrix(name);
  if (values.rows() != 1 && values.cols() != 1) {
    throw StudyError(place_ + ": '" + name + "' is " + std::to_string(values.rows()) + " x " +
                     std::to_string(values.cols()) +
                     " (one row or one column is needed): save it so");
  }
  return {values.data(), values.data() + values.size()};
}

}  // namespace montecarta::experiments
