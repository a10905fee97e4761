// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/several_drives.hpp"

#include "engine/errors.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace montecarta::experiments {
namespace {

/// "gps (headings, errors)" of each reference.
std::string references_in_words(const Itinerary& itinerary) {
  std::vector<std::string> all;
  for (const ReferencePath& path : itinerary.references) {
    all.push_back(path.name + (path.heading.empty() ? " without" : " with") + " headings, " +
                  (path.covariance.empty() ? "without" : "with") + " errors of its own");
  }
  return joined(all, "; ");
}

void expect_alike(const Itinerary& first, const Itinerary& other, std::size_t number) {
  const std::string drive = "drive " + std::to_string(number + 1);
  if (references_in_words(first) != references_in_words(other)) {
    throw StudyError(drive + " has the references " + references_in_words(other) +
                     " (the first one has " + references_in_words(first) +
                     ", and one verdict is by one reference): give all drives files of the same "
                     "names and columns, or name one by scenario.reference");
  }
  if (first.landmarks == other.landmarks) return;
  throw StudyError(drive +
                   " has other surveyed landmarks than the first one (drives of one scenario have "
                   "one map): give all the same landmarks.csv, or none");
}

}  // namespace

SeveralDrives::SeveralDrives(std::vector<RecordedDrive> drives) : drives_(std::move(drives)) {
  expect(!drives_.empty(), "several drives are at least one");
  const auto scans = [](const RecordedDrive& drive) { return drive.itinerary().scans(); };
  itinerary_ = std::ranges::max_element(drives_, {}, scans)->itinerary();
  itinerary_.references.clear();
  for (std::size_t k = 1; k < drives_.size(); ++k)
    expect_alike(drives_.front().itinerary(), drives_[k].itinerary(), k);
}

const Itinerary& SeveralDrives::itinerary_of(std::uint64_t run) const {
  return drives_.at(run).itinerary();
}

void SeveralDrives::generate(std::uint64_t run, Drive& drive) const {
  drives_.at(run).generate(run, drive);
}

}  // namespace montecarta::experiments
