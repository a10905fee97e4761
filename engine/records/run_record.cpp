// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/run_record.hpp"

#include "engine/errors.hpp"
#include "engine/records/fingerprint.hpp"

#include <algorithm>

namespace montecarta::engine {

RunRecord::RunRecord(const RecordLayout& layout)
    : layout_(&layout), own_memory_(layout.bytes()), memory_(own_memory_) {
  clear();
}

RunRecord::RunRecord(const RecordLayout& layout, std::span<std::byte> memory)
    : layout_(&layout), memory_(memory) {
  expect(memory.size() >= layout.bytes(), "a record was lent too little memory");
  clear();
}

void RunRecord::clear() {
  for (std::size_t c = 0; c < layout_->columns().size(); ++c) {
    if (layout_->columns()[c].element == Element::f64) {
      std::ranges::fill(column<double>(c), std::numeric_limits<double>::quiet_NaN());
    } else {
      std::fill_n(memory_.data() + layout_->offset(c), layout_->columns()[c].bytes(), std::byte{0});
    }
  }
  status_ = RunStatus::missing;
  outcome_ = {};
  cpu_seconds_ = std::numeric_limits<double>::quiet_NaN();
}

void RunRecord::mark_complete(double cpu_seconds) {
  status_ = RunStatus::complete;
  outcome_ = {};
  cpu_seconds_ = cpu_seconds;
}

void RunRecord::mark_failed(std::uint32_t step, std::string_view reason, double cpu_seconds) {
  status_ = RunStatus::failed;
  outcome_ = {};
  outcome_.step = step;
  std::size_t length = std::min(reason.size(), kFailureReasonBytes);
  // Never half of a UTF-8 character: step back over continuation bytes.
  const auto continues = [&](std::size_t i) {
    return i < reason.size() && (static_cast<unsigned char>(reason[i]) & 0xC0U) == 0x80U;
  };
  while (length > 0 && continues(length)) --length;
  std::copy_n(reason.begin(), length, outcome_.reason.begin());
  cpu_seconds_ = cpu_seconds;
}

std::string_view RunRecord::failure_reason() const {
  const auto end = std::find(outcome_.reason.begin(), outcome_.reason.end(), '\0');
  return {outcome_.reason.data(), static_cast<std::size_t>(end - outcome_.reason.begin())};
}

std::span<const std::byte> RunRecord::bytes(std::size_t c) const {
  return {memory_.data() + layout_->offset(c), layout_->columns()[c].bytes()};
}

std::uint64_t RunRecord::fingerprint() const {
  Fingerprint fingerprint;
  for (std::size_t c = 0; c < layout_->columns().size(); ++c) fingerprint.add(bytes(c));
  fingerprint.add(std::as_bytes(std::span(&status_, 1)));
  fingerprint.add(std::as_bytes(std::span(&outcome_.step, 1)));
  fingerprint.add(std::as_bytes(std::span(outcome_.reason)));
  return fingerprint.value();
}

void RunRecord::expect_element(const Column& column, std::size_t size) {
  expect(size_of(column.element) == size, "a column was asked for as another element type");
}

void expect_known(std::span<const RunStatus> statuses, const std::string& place) {
  if (std::ranges::all_of(statuses, [](RunStatus s) { return s <= RunStatus::spared; })) return;
  throw StudyError(place + ": a status is none of 0, 1, 2, 3 (the file is damaged): make it anew");
}

}  // namespace montecarta::engine
