// SPDX-License-Identifier: BSD-3-Clause
#include "filters/association/map_association.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"

#include <algorithm>
#include <string>

namespace montecarta::filters {

MapAssociation::MapAssociation(const FilterSetup& setup)
    : settings_(setup.association),
      log_new_density_(log_new_density(setup.association, setup.belief)),
      slot_of_identity_(setup.landmarks, kUnseen) {}

void MapAssociation::clear() {
  std::ranges::fill(slot_of_identity_, kUnseen);
  made_of_.clear();
}

void MapAssociation::pair_by_identity(Scan scan) {
  pairings_.clear();
  for (const Detection& detection : scan) pairings_.push_back(pairing_by_identity(detection));
  counts_ = association_counts(scan, pairings_, made_of_);
}

Pairing MapAssociation::pairing_by_identity(const Detection& detection) const {
  if (detection.identity == Detection::kClutter) return {};
  const std::size_t slot = slot_of(static_cast<std::size_t>(detection.identity));
  if (slot == kUnseen) return {.kind = PairingKind::fresh};
  return {.kind = PairingKind::matched, .landmark = static_cast<std::uint32_t>(slot)};
}

void MapAssociation::pair_nearest(Scan scan, std::span<const NearestSearch> searches) {
  pairings_.clear();
  for (const NearestSearch& search : searches)
    pairings_.push_back(decide_pairing(search, settings_));
  exclude_rivals(pairings_);
  counts_ = association_counts(scan, pairings_, made_of_);
}

void MapAssociation::add(std::int32_t identity) {
  const std::size_t slot = made_of_.size();
  if (known()) {
    const auto k = static_cast<std::size_t>(identity);
    if (k >= slot_of_identity_.size()) slot_of_identity_.resize(k + 1, kUnseen);
    slot_of_identity_[k] = static_cast<std::uint32_t>(slot);
  } else if (slot >= settings_.most_landmarks) {
    throw std::runtime_error(
        formatted("the map grew beyond {} landmarks", settings_.most_landmarks));
  }
  made_of_.push_back(identity);
}

std::size_t MapAssociation::slot_of(std::size_t k) const {
  if (!known()) return k;
  return k < slot_of_identity_.size() ? slot_of_identity_[k] : kUnseen;
}

}  // namespace montecarta::filters
