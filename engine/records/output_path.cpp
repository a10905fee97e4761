// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/output_path.hpp"

#include "engine/errors.hpp"

#include <system_error>

namespace montecarta::engine {

std::filesystem::path part_of(std::filesystem::path path) { return path += ".part"; }

bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

void expect_free(const std::filesystem::path& path) {
  if (!is_there(path)) return;
  throw StudyError(path.string() +
                   ": exists (nothing is overwritten unasked): add --force to replace it, or "
                   "choose another path");
}

}  // namespace montecarta::engine
