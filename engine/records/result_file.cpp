// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/result_file.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/check_file.hpp"
#include "engine/records/read_description.hpp"
#include "engine/records/result_format.hpp"
#include "engine/records/sum_groups.hpp"
#include "engine/text/visible_text.hpp"

#include <algorithm>
#include <mutex>
#include <type_traits>

namespace montecarta::engine {
namespace {

const std::filesystem::path& existing(const std::filesystem::path& path) {
  if (is_there(path)) return path;
  throw StudyError(
      "{}: no such file{}", path,
      is_there(part_of(path))
          ? formatted(
                " (the work is unfinished): read {}, or finish it with 'montecarta run --resume'",
                part_of(path))
          : ": check the spelling");
}

std::mutex reading_by_hdf5;  // the library may be built for one thread

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

/// Reads elements of a stored type. Returns false if only HDF5 converts that type.
template <class Number>
bool read_elements(const PosixFile& file, std::uint64_t offset, Element element,
                   std::span<Number> out) {
  if (element == Element::u8) return read_as<std::uint8_t>(file, offset, out), true;
  if (element == Element::u16) return read_as<std::uint16_t>(file, offset, out), true;
  if (element == Element::u32) return read_as<std::uint32_t>(file, offset, out), true;
  if constexpr (std::is_same_v<Number, double>) {
    if (element == Element::f64) return read_as<double>(file, offset, out), true;
  }
  return false;
}

}  // namespace

ResultFile::ResultFile(const std::filesystem::path& path)
    : path_(existing(path)),
      has_seal_(check_file(path_) == Seal::holds),
      file_(h5::open_file(path_)),
      bytes_(path_, PosixFile::Mode::read),
      description_(read_description(file_, path_)) {
  if (has_seal_) slabs_ = find_slabs(path_, description_);
}

bool ResultFile::has_errors() const {
  return has_truth() ||
         std::ranges::any_of(cells(), [](const StoredCell& cell) { return cell.has("error"); });
}

std::size_t ResultFile::index_of(const StoredCell& cell) const {
  const auto found = std::ranges::find(cells(), cell.label, &StoredCell::label);
  expect(found != cells().end(), "a cell of another file was given");
  return static_cast<std::size_t>(found - cells().begin());
}

template <class T>
std::vector<T> ResultFile::per_run(const std::string& dataset, Element element) const {
  std::vector<T> values(runs().size());
  h5::read(h5::open_dataset(file_, dataset), element, std::as_writable_bytes(std::span(values)));
  return values;
}

std::vector<RunStatus> ResultFile::status(const StoredCell& cell) const {
  auto statuses = per_run<RunStatus>(formatted("cells/{}/status", cell.label), Element::u8);
  require_known(statuses, formatted("{}: cell '{}'", path(), cell.label));
  return statuses;
}

void ResultFile::expect_whole(const StoredCell& cell, std::size_t i) const {
  if (!slabs_) return;
  thread_local std::vector<std::byte> buffer;
  const CellSlabs& slabs = slabs_->cells.at(index_of(cell));
  if (run_is_whole(bytes_, slabs, i, buffer) &&
      (!is_stored(status_of(bytes_, slabs, i)) || truth_is_whole(bytes_, *slabs_, i, buffer))) {
    return;
  }
  throw StudyError(
      "{}: cell '{}', run {}: damaged (its bytes do not fit its fingerprint): take a copy that is "
      "whole, or run the study again",
      path(), cell.label, runs()[i]);
}

std::vector<std::string> ResultFile::failure_reasons(const StoredCell& cell) const {
  const h5::Handle dataset =
      h5::open_dataset(file_, formatted("cells/{}/failure_reason", cell.label));
  std::string texts(runs().size() * kFailureReasonBytes, '\0');
  h5::read(dataset, Element::u8, std::as_writable_bytes(std::span(texts)));
  std::vector<std::string> reasons;
  for (std::size_t i = 0; i < runs().size(); ++i)
    reasons.push_back(visible(texts.substr(i * kFailureReasonBytes, kFailureReasonBytes).c_str()));
  return reasons;
}

std::vector<std::uint32_t> ResultFile::failure_steps(const StoredCell& cell) const {
  return per_run<std::uint32_t>(formatted("cells/{}/failure_step", cell.label), Element::u32);
}

std::vector<double> ResultFile::cpu_seconds(const StoredCell& cell) const {
  return per_run<double>(formatted("timing/{}/cpu_seconds", cell.label), Element::f64);
}

double ResultFile::wall_seconds() const {
  double seconds = 0.0;
  h5::read(h5::open_dataset(file_, "timing/wall_seconds"), Element::f64,
           std::as_writable_bytes(std::span(&seconds, 1)));
  return seconds;
}

std::vector<std::uint64_t> ResultFile::fingerprints(const StoredCell& cell) const {
  return per_run<std::uint64_t>(formatted("cells/{}/fingerprint", cell.label), Element::u64);
}

std::vector<SumGroup> ResultFile::sum_groups(const StoredCell& cell) const {
  if (!slabs_) {
    throw StudyError(path().string() +
                     ": its sums cannot be checked (another program rewrote the file, which has "
                     "lost its seal): use the file as montecarta wrote it");
  }
  return find_groups(bytes_, slabs_->sums.at(index_of(cell)), *description_.sums);
}

std::vector<std::uint64_t> ResultFile::sums(const SumGroup& group) const {
  return read_sums(bytes_, group);
}

std::vector<double> ResultFile::cpu_seconds_in_sums(const StoredCell& cell) const {
  const SummedRuns& sums = *description_.sums;
  std::vector<double> seconds(sums.last_run - sums.first_run);
  h5::read(h5::open_dataset(file_, formatted("timing/{}/{}", cell.label, format::kSumSeconds)),
           Element::f64, std::as_writable_bytes(std::span(seconds)));
  return seconds;
}

bool ResultFile::holds(const StoredCell& cell, std::string_view column, std::size_t i) const {
  return cell.has(column) || (i < description_.full_runs_here() && cell.find(column) != nullptr);
}

template <class Number>
void ResultFile::read_row(const std::string& dataset, const Slab* slab, Element element,
                          std::size_t i, std::span<Number> out) const {
  const bool fits =
      slab != nullptr && slab->holds(i) && slab->run_bytes == out.size() * size_of(element);
  if (fits && read_elements(bytes_, slab->at(i), element, out)) return;
  const std::lock_guard lock(reading_by_hdf5);
  auto opened = datasets_.find(dataset);
  if (opened == datasets_.end())
    opened = datasets_.emplace(dataset, h5::open_dataset(file_, dataset)).first;
  constexpr auto wanted = std::is_same_v<Number, double> ? Element::f64 : Element::u32;
  h5::read_row(opened->second, i, wanted, std::as_writable_bytes(out));
}

template <class Number>
void ResultFile::read_column(const StoredCell& cell, std::string_view column, std::size_t i,
                             std::span<Number> out) const {
  const std::size_t c = index_of(cell);
  const StoredCell& here = cells()[c];
  const Column* found = here.find(column);
  if (found == nullptr) {
    throw RunError(
        "{}: cell '{}' has no column '{}' (record.columns did not ask for it): run the study again "
        "with it",
        path_, cell.label, column);
  }
  const auto k = static_cast<std::size_t>(found - here.columns.data());
  read_row(here.dataset_of(k), slabs_ ? &slabs_->cells[c].columns[k] : nullptr, found->element, i,
           out);
}

void ResultFile::read(const StoredCell& cell, std::string_view column, std::size_t i,
                      std::span<double> out) const {
  read_column(cell, column, i, out);
}

void ResultFile::read(const StoredCell& cell, std::string_view column, std::size_t i,
                      std::span<std::uint32_t> out) const {
  read_column(cell, column, i, out);
}

void ResultFile::read_truth(std::size_t i, std::span<double> out) const {
  expect(has_truth(), "the truth was asked for where nobody knows it");
  read_row("truth/pose", slabs_ ? &slabs_->truth->pose : nullptr, Element::f64, i, out);
}

std::vector<Eigen::Vector2d> ResultFile::landmarks_of(std::size_t i) const {
  std::vector<Eigen::Vector2d> points = landmarks();
  if (!has_own_landmarks()) return points;
  read_row("truth/landmarks", slabs_ ? &*slabs_->truth->landmarks : nullptr, Element::f64, i,
           std::span(reinterpret_cast<double*>(points.data()), 2 * points.size()));
  return points;
}

}  // namespace montecarta::engine
