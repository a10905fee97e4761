// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/run_dataset.hpp"

#include <algorithm>
#include <mutex>
#include <type_traits>
#include <utility>
#include <vector>

namespace montecarta::engine {
namespace {

std::mutex reading_by_hdf5;  // the library may be built for one thread

/// Returns the place of the rows; nullopt if they are not in one piece, or not all inside a file of
/// `file_bytes`.
std::optional<Slab> rows_of(const h5::Handle& dataset, std::uint64_t file_bytes) {
  const std::optional<std::uint64_t> place = h5::place(dataset);
  const h5::Shape shape = h5::shape(dataset);
  const std::uint64_t bytes = h5::stored_bytes(dataset);
  if (!place || shape.empty() || shape[0] == 0 || bytes % shape[0] != 0) return std::nullopt;
  if (bytes > file_bytes || *place > file_bytes - bytes) return std::nullopt;
  return Slab{*place, bytes / shape[0], shape[0]};
}

template <class Stored, class Number>
void read_as(const PosixFile& file, std::uint64_t offset, std::span<Number> out) {
  if constexpr (std::is_same_v<Stored, Number>)
    return file.read_at(offset, std::as_writable_bytes(out));
  thread_local std::vector<Stored> longest;
  if (longest.size() < out.size()) longest.resize(out.size());
  const auto row = std::span(longest).first(out.size());
  file.read_at(offset, std::as_writable_bytes(row));
  std::ranges::copy(row, out.begin());
}

}  // namespace

RunDataset::RunDataset(h5::Handle dataset, const PosixFile* file)
    : dataset_(std::move(dataset)),
      element_(h5::element(dataset_)),
      slab_(file != nullptr ? rows_of(dataset_, file->size()) : std::nullopt),
      file_(file) {}

template <class Number>
bool RunDataset::read_in_one_piece(std::uint64_t i, std::span<Number> out) const {
  if (!element_ || !slab_ || !slab_->holds(i)) return false;
  if (slab_->run_bytes != out.size() * size_of(*element_)) return false;
  const std::uint64_t offset = slab_->at(i);
  if (*element_ == Element::u8) {
    read_as<std::uint8_t>(*file_, offset, out);
  } else if (*element_ == Element::u16) {
    read_as<std::uint16_t>(*file_, offset, out);
  } else if (*element_ == Element::u32) {
    read_as<std::uint32_t>(*file_, offset, out);
  } else if (*element_ == Element::f64 && std::is_same_v<Number, double>) {
    read_as<double>(*file_, offset, out);
  } else {
    return false;
  }
  return true;
}

template <class Number>
void RunDataset::read(std::uint64_t i, std::span<Number> out) const {
  if (read_in_one_piece(i, out)) return;
  const std::lock_guard lock(reading_by_hdf5);
  constexpr auto element = std::is_same_v<Number, double> ? Element::f64 : Element::u32;
  h5::read_row(dataset_, i, element, std::as_writable_bytes(out));
}

template void RunDataset::read(std::uint64_t, std::span<double>) const;
template void RunDataset::read(std::uint64_t, std::span<std::uint32_t>) const;

}  // namespace montecarta::engine
