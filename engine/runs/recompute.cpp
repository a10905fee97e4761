// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/recompute.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/recorder.hpp"
#include "engine/runs/worker.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>

namespace montecarta::engine {
namespace {

using Bytes = std::span<const std::byte>;

template <class T>
T element_at(Bytes bytes, std::size_t i) {
  T value{};
  std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
  return value;
}

std::string text_of(Bytes bytes, Element element, std::size_t i) {
  switch (element) {
    case Element::u8:
      return std::to_string(element_at<std::uint8_t>(bytes, i));
    case Element::u16:
      return std::to_string(element_at<std::uint16_t>(bytes, i));
    case Element::u32:
      return std::to_string(element_at<std::uint32_t>(bytes, i));
    case Element::u64:
      return std::to_string(element_at<std::uint64_t>(bytes, i));
    case Element::f64:
      break;
  }
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, element_at<double>(bytes, i)).ptr;
  return {digits, end};
}

/// Position of element `i`, e.g. "time 12, component 1".
std::string position_text(const Column& column, std::size_t i) {
  std::string text;
  std::size_t block = column.elements();
  for (std::size_t a = 0; a < column.axes.size(); ++a) {
    block /= column.shape[a];
    text += formatted("{}{} {}", a == 0 ? "" : ", ", name_of(column.axes[a]), i / block);
    i %= block;
  }
  return text;
}

/// Describes the numbers of a column that differ; nullopt if all bits are equal.
std::optional<std::string> compare(const Column& column, Bytes stored, Bytes computed) {
  if (std::ranges::equal(stored, computed)) return std::nullopt;
  const std::size_t width = size_of(column.element);
  std::size_t first = column.elements(), count = 0;
  for (std::size_t i = 0; i < column.elements(); ++i) {
    if (std::ranges::equal(stored.subspan(i * width, width), computed.subspan(i * width, width)))
      continue;
    first = std::min(first, i);
    ++count;
  }
  return formatted("{} differs in {} of {} numbers, first at ({}): stored {}, computed {}",
                   column.name, count, column.elements(), position_text(column, first),
                   text_of(stored, column.element, first),
                   text_of(computed, column.element, first));
}

std::vector<std::byte> read_run(const PosixFile& file, const Slab& slab, std::size_t run_index) {
  std::vector<std::byte> bytes(slab.run_bytes);
  file.read_at(slab.at(run_index), bytes);
  return bytes;
}

bool equals(const PosixFile& file, const Slab& slab, std::size_t run_index, Bytes computed) {
  return std::ranges::equal(read_run(file, slab, run_index), computed);
}

Column truth_column(std::size_t rows) {
  return {"true pose", Element::f64, {Axis::time, Axis::component}, {rows, 3}, "m, m, rad", ""};
}

Column landmark_column(std::size_t rows) {
  return {"true landmark", Element::f64, {Axis::landmark, Axis::coordinate}, {rows, 2}, "m", ""};
}

ResultDescription comparable(const StudyPlan& plan, const ResultDescription& stored) {
  ResultDescription planned = describe(plan, {});
  planned.study_sha256 = stored.study_sha256;  // later versions may spell a study differently
  return planned;
}

}  // namespace

Recomputation::Recomputation(const std::filesystem::path& path, const ResultDescription& stored,
                             const StudyPlan& plan)
    : stored_(stored), plan_(plan), file_(path, PosixFile::Mode::read) {
  if (const auto differs = engine::difference(comparable(plan, stored), stored, path))
    throw StudyError(*differs);
  slabs_ = find_slabs(path, stored);
  layouts_ = layouts_of(plan, Detail::usual);
  full_layouts_ = layouts_of(plan, Detail::full);
}

std::optional<std::string> Recomputation::difference(StoredRun which) const {
  const std::uint64_t run = stored_.runs.at(which.run_index);
  const Cell& cell = plan_.cells.at(which.cell);
  Drive drive;
  plan_.drives->generate(run, drive);
  auto differs = difference(drive, which.run_index);
  if (!differs) {
    const std::unique_ptr<SlamFilter> filter = cell.make_filter();
    RunRecord record((run < plan_.columns.full_runs ? full_layouts_ : layouts_)[which.cell]);
    Recorder recorder(record);
    const SpareThreads none(Parallel::serial(), 1);
    const StopRequest never;
    const RunConditions conditions{plan_.seed, run,  plan_.drives->itinerary_of(run),
                                   drive,      none, never};
    expect(run_one(conditions, *filter, recorder, record) == RunEnd::recorded, "nobody dropped it");
    differs = difference(record, which);
  }
  if (!differs) return std::nullopt;
  std::vector<std::byte> buffer;
  const bool whole = truth_is_whole(file_, slabs_, which.run_index, buffer) &&
                     run_is_whole(file_, slabs_.cells[which.cell], which.run_index, buffer);
  return formatted(
      "{}, run {}: {}{}", cell.label, run, *differs,
      whole ? "" : " (and the stored bytes do not fit their fingerprint: damaged, or altered)");
}

std::optional<std::string> Recomputation::difference(const Drive& drive,
                                                     std::size_t run_index) const {
  if (!slabs_.truth) return std::nullopt;
  const Itinerary& itinerary = plan_.drives->itinerary();
  std::vector<Pose> truth = drive.truth;
  if (plan_.columns.scans_only) {
    truth.clear();
    for (std::uint32_t step : itinerary.scan_step) truth.push_back(drive.truth[step]);
  }
  const auto stored = read_run(file_, slabs_.truth->pose, run_index);
  if (auto differs = compare(truth_column(truth.size()), stored, std::as_bytes(std::span(truth)))) {
    return differs;
  }
  if (!slabs_.truth->landmarks) return std::nullopt;
  const std::vector<Eigen::Vector2d> landmarks = plan_.own_landmarks(stored_.runs[run_index]);
  return compare(landmark_column(landmarks.size()),
                 read_run(file_, *slabs_.truth->landmarks, run_index),
                 std::as_bytes(std::span(landmarks)));
}

std::optional<std::string> Recomputation::difference(const RunRecord& record,
                                                     StoredRun which) const {
  const CellSlabs& slabs = slabs_.cells[which.cell];
  const std::size_t i = which.run_index;
  const RunStatus status = record.status();
  const std::uint32_t step = record.failure_step();
  if (!equals(file_, slabs.status, i, std::as_bytes(std::span(&status, 1))))
    return "one of them failed, the stored or the computed one";
  if (!equals(file_, slabs.failure_step, i, std::as_bytes(std::span(&step, 1))) ||
      !equals(file_, slabs.failure_reason, i, std::as_bytes(record.failure_text())))
    return "it failed at another step or for another reason";
  const std::vector<Column>& columns = record.layout().columns();
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (auto differs = compare(columns[c], read_run(file_, slabs.columns[c], i), record.bytes(c)))
      return differs;
  }
  return std::nullopt;
}

}  // namespace montecarta::engine
