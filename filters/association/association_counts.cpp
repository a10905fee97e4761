// SPDX-License-Identifier: BSD-3-Clause
#include "filters/association/association_counts.hpp"

#include <algorithm>

namespace montecarta::filters {
namespace {

/// The count that one detection belongs to; nullptr where clutter was rightly left out, or where
/// nobody knows.
double* count_of(std::int32_t identity, const Pairing& pairing,
                 std::span<const std::int32_t> made_of, AssociationCounts& counts) {
  if (identity == Detection::kUnidentified) return nullptr;
  const bool left_out = pairing.kind == PairingKind::ignored;
  if (identity == Detection::kClutter) return left_out ? nullptr : &counts.clutter;
  if (left_out) return &counts.missed;
  if (pairing.kind == PairingKind::matched) {
    return made_of[pairing.landmark] == identity ? &counts.correct : &counts.wrong;
  }
  const bool held = std::ranges::find(made_of, identity) != made_of.end();
  return held ? &counts.new_again : &counts.correct;
}

}  // namespace

AssociationCounts association_counts(Scan scan, std::span<const Pairing> pairings,
                                     std::span<const std::int32_t> made_of) {
  AssociationCounts counts;
  for (std::size_t k = 0; k < scan.size(); ++k) {
    double* const count = count_of(scan[k].identity, pairings[k], made_of, counts);
    if (count != nullptr) *count += 1.0;
  }
  return counts;
}

void add(const AssociationCounts& counts, double share, AssociationCounts& sum) {
  sum.correct += share * counts.correct;
  sum.wrong += share * counts.wrong;
  sum.new_again += share * counts.new_again;
  sum.missed += share * counts.missed;
  sum.clutter += share * counts.clutter;
}

}  // namespace montecarta::filters
