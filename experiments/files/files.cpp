// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/files.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <string_view>
#include <system_error>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

std::array<fs::path, 3> shipped_roots() {
  std::error_code none;
  const fs::path executable = fs::read_symlink("/proc/self/exe", none);
  return {executable.parent_path().parent_path() / "share" / "montecarta", MONTECARTA_INSTALLED_DIR,
          MONTECARTA_SHIPPED_DIR};
}

}  // namespace

std::optional<fs::path> shipped_file(const std::string& folder, const std::string& name) {
  for (const fs::path& root : shipped_roots()) {
    std::error_code none;
    if (fs::is_regular_file(root / folder / name, none)) return root / folder / name;
  }
  return std::nullopt;
}

std::vector<std::string> shipped_names(const std::string& folder, const std::string& ending) {
  std::set<std::string> names;
  for (const fs::path& root : shipped_roots()) {
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(root / folder, none)) {
      if (entry.path().extension() == ending) names.insert(entry.path().stem().string());
    }
  }
  return {names.begin(), names.end()};
}

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

std::string text_file(const std::filesystem::path& path) {
  constexpr std::string_view kUtf8 = "\xEF\xBB\xBF", kUtf16[] = {"\xFF\xFE", "\xFE\xFF"};
  std::string text = whole_file(path);
  if (text.starts_with(kUtf16[0]) || text.starts_with(kUtf16[1])) {
    throw StudyError(path.string() +
                     ": is in UTF-16 (two bytes a character; UTF-8 is read): save it as UTF-8");
  }
  if (text.starts_with(kUtf8)) text.erase(0, kUtf8.size());
  const std::size_t nul = text.find('\0');
  if (nul == text.npos) return text;
  const auto line =
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(nul), '\n');
  throw StudyError(path.string() + ":" + std::to_string(line) +
                   ": a NUL byte (this is no text, or it is damaged): save it as UTF-8");
}

}  // namespace montecarta::experiments
