// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/whole_file.hpp"

#include "engine/errors.hpp"

#include <fstream>
#include <system_error>

namespace montecarta::experiments {

std::string whole_file(const std::filesystem::path& path) {
  std::error_code failure;
  const bool is_file = std::filesystem::is_regular_file(path, failure);
  const std::uintmax_t size = is_file ? std::filesystem::file_size(path, failure) : 0;
  std::ifstream file(path, std::ios::binary);
  if (!is_file || failure || !file) {
    throw StudyError(path.string() +
                     ": cannot be opened (is it there, a file, and readable?): check the path");
  }
  if (size > kLargestFile) {
    throw StudyError(path.string() + ": " + std::to_string(size) +
                     " bytes (at most 512 MiB are read): split it or thin it out");
  }
  std::string bytes(static_cast<std::size_t>(size), '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (file.gcount() != static_cast<std::streamsize>(bytes.size())) {
    throw StudyError(path.string() + ": ends before its last byte (did it change while it was " +
                     "read?): read it again");
  }
  return bytes;
}

}  // namespace montecarta::experiments
