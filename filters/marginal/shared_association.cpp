// SPDX-License-Identifier: BSD-3-Clause
#include "filters/marginal/shared_association.hpp"

#include "engine/errors.hpp"
#include "filters/moments/linearised.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace montecarta {

SharedAssociation::SharedAssociation(const FilterSetup& setup)
    : settings_(setup.association),
      noise_(SensorNoise::of(setup.belief)),
      log_new_density_(log_new_density(setup.association, setup.belief)),
      slot_of_identity_(setup.landmarks, kUnseen) {}

void SharedAssociation::clear() {
  std::fill(slot_of_identity_.begin(), slot_of_identity_.end(), kUnseen);
  made_of_.clear();
}

void SharedAssociation::associate(Scan scan) {
  pairings_.assign(scan.size(), {});
  for (std::size_t k = 0; k < scan.size(); ++k) {
    if (scan[k].identity == Detection::kClutter) continue;
    const std::uint32_t slot = slot_of_identity_.at(static_cast<std::size_t>(scan[k].identity));
    pairings_[k] = slot == kUnseen ? Pairing{.verdict = Verdict::fresh}
                                   : Pairing{.verdict = Verdict::matched, .landmark = slot};
  }
  sort_out(scan, pairings_);
}

void SharedAssociation::associate(Scan scan, const SharedMap& map, bool map_is_exact,
                                  const PoseMoments& predicted) {
  const Symmetric3<double> P = symmetric_of(predicted.covariance);
  pairings_.assign(scan.size(), {});
  for (std::size_t k = 0; k < scan.size(); ++k) {
    NearestSearch search;
    for (std::uint32_t slot = 0; slot < map.size(); ++slot) {
      const auto s = sightline(predicted.mean, map[slot].mean);
      if (!is_usable(s)) continue;
      const auto covariance = map_is_exact ? Symmetric2<double>{} : map[slot].covariance();
      const auto v = innovation_of(P, s, residual(sight_of(scan[k]), s), covariance, noise_);
      const double distance = v.squared();
      search.offer(slot, distance, distance + std::log(v.S.determinant()), settings_.gate);
    }
    pairings_[k] = judge(search, settings_);
  }
  exclude_rivals(pairings_);
  sort_out(scan, pairings_);
}

void SharedAssociation::sort_out(Scan scan, const std::vector<Pairing>& pairings) {
  matches_.clear();
  fresh_.clear();
  unmatched_ = 0;
  counts_ = association_counts(scan, pairings, made_of_);
  for (std::size_t k = 0; k < scan.size(); ++k) {
    unmatched_ += pairings[k].verdict != Verdict::matched;
    if (pairings[k].verdict == Verdict::fresh) fresh_.push_back(scan[k]);
    if (pairings[k].verdict == Verdict::matched)
      matches_.push_back({pairings[k].landmark, sight_of(scan[k])});
  }
}

double SharedAssociation::unmatched_log_density() const {
  return known() ? 0.0 : log_new_density_ * static_cast<double>(unmatched_);
}

void SharedAssociation::give_slot(const Detection& fresh, std::size_t slot) {
  if (known()) {
    slot_of_identity_[static_cast<std::size_t>(fresh.identity)] = static_cast<std::uint32_t>(slot);
  } else if (slot >= settings_.most_landmarks) {
    throw RunError("the map grew beyond " + std::to_string(settings_.most_landmarks) +
                   " landmarks");
  }
  made_of_.push_back(fresh.identity);
}

std::size_t SharedAssociation::slot_of_row(std::size_t k) const {
  if (!known()) return k;
  return k < slot_of_identity_.size() ? slot_of_identity_[k] : kUnseen;
}

}  // namespace montecarta
