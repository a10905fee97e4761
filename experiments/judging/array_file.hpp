// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/forked_reader.hpp"
#include "engine/records/h5.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The arrays and text attributes at the root of an HDF5 file that any program may have written.
/// Another process opens it (ForkedReader), so that no damage to it crashes this one. Members throw
/// StudyError with file and array. For use by one thread.
class ArrayFile {
 public:
  explicit ArrayFile(const std::filesystem::path& path);

  std::vector<std::string> members() const;
  bool has(const std::string& name) const;
  bool is_group(const std::string& name) const;
  h5::Shape shape(const std::string& array) const;
  /// The texts of an attribute, none if it has no texts; nullopt if there is no such attribute.
  std::optional<std::vector<std::string>> texts(const std::string& attribute) const;
  /// Reads index `row` of the first axis of an array; all of it if `row` is nullopt.
  std::vector<double> numbers(const std::string& array, std::optional<std::size_t> row) const;

 private:
  ForkedReader copy_;
};

}  // namespace montecarta::experiments
