// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/seal.hpp"

#include "engine/errors.hpp"
#include "engine/records/fingerprint.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

namespace montecarta::engine {
namespace {

using Words = std::vector<std::uint64_t>;

static_assert(std::endian::native == std::endian::little, "files are little-endian");

constexpr std::string_view kHdf5 = "\x89HDF\r\n\x1a\n";
constexpr std::string_view kMagic = "\x89MCSEAL\n";
constexpr std::uint64_t kVersion = 1;
constexpr std::size_t kHeadWords = 4;  // words: magic, version, size of the file, number of ranges
constexpr std::size_t kTailWords = 2;  // words: fingerprint of the file, fingerprint of the seal
constexpr std::size_t kSuperblockBytes = 52;  // contains the end address in every version

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw StudyError("{}: damaged ({}): take a copy that is whole, or run the study again", path,
                   why);
}

[[noreturn]] void refuse_other(const std::filesystem::path& path) {
  throw StudyError(path.string() +
                   ": not a readable HDF5 file (another kind, cut short, or damaged): "
                   "give a file that 'montecarta run' wrote");
}

template <class T>
T value_at(std::span<const std::byte> bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

/// End of the file according to its HDF5 superblock. Throws StudyError if the file does not begin
/// like HDF5.
std::uint64_t end_of_hdf5(const PosixFile& file) {
  std::array<std::byte, kSuperblockBytes> head{};
  if (file.size() >= head.size()) file.read_at(0, head);
  if (std::memcmp(head.data(), kHdf5.data(), kHdf5.size()) != 0) {
    refuse_other(file.path());
  }
  const auto version = value_at<std::uint8_t>(head, 8);
  const std::size_t widths = version < 2 ? 13 : 9;  // offset of the widths of addresses and lengths
  if (version > 3 || value_at<std::uint8_t>(head, widths) != 8) {
    refuse(file.path(), "its superblock is of an unknown kind");
  }
  constexpr std::array<std::size_t, 4> end_address = {40, 44, 28, 28};
  return value_at<std::uint64_t>(head, end_address[version]);
}

void add_bytes(const PosixFile& file, std::uint64_t from, std::uint64_t to,
               std::vector<std::byte>& buffer, Fingerprint& fingerprint) {
  for (; from < to; from += buffer.size()) {
    buffer.resize(std::min<std::uint64_t>(to - from, 1U << 16U));
    file.read_at(from, buffer);
    fingerprint.add(buffer);
  }
}

/// Fingerprint of all bytes before `end` outside the ranges.
std::uint64_t fingerprint_outside(const PosixFile& file, std::span<const ByteRange> ranges,
                                  std::uint64_t end) {
  Fingerprint fingerprint;
  std::vector<std::byte> buffer;
  std::uint64_t from = 0;
  for (const ByteRange& range : ranges) {
    add_bytes(file, from, range.offset, buffer, fingerprint);
    from = range.offset + range.length;
  }
  add_bytes(file, from, end, buffer, fingerprint);
  return fingerprint.value();
}

std::uint64_t fingerprint_of(std::span<const std::uint64_t> words) {
  Fingerprint fingerprint;
  fingerprint.add(std::as_bytes(words));
  return fingerprint.value();
}

/// The ranges of an undamaged seal. Throws StudyError unless they are increasing and before `end`.
std::vector<ByteRange> ranges_of(const Words& seal, std::uint64_t end,
                                 const std::filesystem::path& path) {
  std::vector<ByteRange> ranges;
  std::uint64_t from = 0;
  for (std::size_t i = kHeadWords; i + kTailWords < seal.size(); i += 2) {
    const ByteRange range{seal[i], seal[i + 1]};
    if (range.offset < from || range.offset > end || range.length > end - range.offset) {
      refuse(path, "the seal at its end contradicts itself");
    }
    from = range.offset + range.length;
    ranges.push_back(range);
  }
  return ranges;
}

Words read_seal(const PosixFile& file, std::uint64_t begin, std::uint64_t end) {
  const std::string missing = "the seal at its end is not whole";
  if (end - begin < (kHeadWords + kTailWords) * sizeof(std::uint64_t)) {
    refuse(file.path(), missing);
  }
  Words head(kHeadWords);
  file.read_at(begin, std::as_writable_bytes(std::span(head)));
  const std::uint64_t ranges = head[3];
  if (std::memcmp(head.data(), kMagic.data(), kMagic.size()) != 0 || head[2] != end ||
      ranges > (end - begin) / (2 * sizeof(std::uint64_t)) ||
      (kHeadWords + 2 * ranges + kTailWords) * sizeof(std::uint64_t) != end - begin) {
    refuse(file.path(), missing);
  }
  Words seal(kHeadWords + 2 * ranges + kTailWords);
  file.read_at(begin, std::as_writable_bytes(std::span(seal)));
  if (fingerprint_of(std::span(seal).first(seal.size() - 1)) != seal.back()) {
    refuse(file.path(), missing);
  }
  return seal;
}

}  // namespace

void put_seal(const PosixFile& file, const std::vector<ByteRange>& open) {
  const std::uint64_t begin = file.size();
  Words seal(kHeadWords);
  std::memcpy(seal.data(), kMagic.data(), kMagic.size());
  seal[1] = kVersion;
  seal[2] = begin + (kHeadWords + 2 * open.size() + kTailWords) * sizeof(std::uint64_t);
  seal[3] = open.size();
  for (const ByteRange& range : open) seal.insert(seal.end(), {range.offset, range.length});
  seal.push_back(fingerprint_outside(file, open, begin));
  seal.push_back(fingerprint_of(seal));
  file.write_at(begin, std::as_bytes(std::span(seal)));
}

Seal check_seal(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored)) {
    refuse_other(path);
  }
  const PosixFile file(path, PosixFile::Mode::read);
  const std::uint64_t size = file.size();
  const std::uint64_t end = end_of_hdf5(file);
  if (end == size) return Seal::absent;
  if (end > size) refuse(path, "it was cut short, or its superblock has changed");
  const Words seal = read_seal(file, end, size);
  if (seal[1] != kVersion) {
    throw StudyError(
        "{}: has a seal of version {} (this program knows version {}): use the montecarta that "
        "wrote it",
        path, seal[1], kVersion);
  }
  const std::uint64_t stored = seal[seal.size() - kTailWords];
  if (fingerprint_outside(file, ranges_of(seal, end, path), end) != stored) {
    refuse(path, "bytes that never change once it is laid out do not fit their fingerprint");
  }
  return Seal::holds;
}

}  // namespace montecarta::engine
