// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/output_guard.hpp"

#include "engine/errors.hpp"

#include <fstream>
#include <system_error>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return fs::equivalent(a, b, ignored);
}

bool is_other_kind(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored) || fs::is_empty(path, ignored)) return false;
  const std::string signature = "\x89HDF\r\n\x1a\n";
  std::string head(signature.size(), '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file) return false;  // opening it for writing will say why
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  return head != signature;
}

}  // namespace

void refuse_input_as_output(const fs::path& output, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    for (const std::string& name : {input, input + ".part"}) {
      if (!is_same_file(output, name)) continue;
      throw StudyError(output.string() + ": is the same file as " + name +
                       " (what is read would be destroyed, --force or not): choose another name");
    }
  }
}

void refuse_to_replace_other_kinds(const fs::path& output) {
  for (const fs::path& path : {output, fs::path(output.string() + ".part")}) {
    if (!is_other_kind(path)) continue;
    throw StudyError(path.string() +
                     ": is no HDF5 file (--force replaces results only): choose another name");
  }
}

void refuse_existing(const fs::path& folder, const std::vector<std::string>& names) {
  std::error_code ignored;
  for (const std::string& name : names) {
    if (!fs::exists(folder / name, ignored)) continue;
    throw StudyError((folder / name).string() +
                     ": is there already (nothing is overwritten unasked): choose another name, or "
                     "add --force");
  }
}

}  // namespace montecarta::experiments
