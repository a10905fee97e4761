// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/replay/replay.hpp"
#include "engine/errors.hpp"

#include <algorithm>

namespace montecarta::analysis {
namespace {

using Indices = std::vector<std::uint32_t>;

/// Index at scan `before` of the ancestor of particle `i` of scan `scan`.
std::uint32_t ancestor_at(const StoredParticles& stored, std::size_t scan, std::size_t before,
                          std::uint32_t i) {
  for (; scan > before; --scan) {
    i = stored.ancestor[scan * stored.count + i];
    if (i >= stored.count) throw StudyError("ancestor: no such particle (the file is damaged)");
  }
  return i;
}

/// Adds particles, evenly over the indices, until there are `most`; sorted.
void fill_up(Indices& shown, std::size_t count, std::size_t most) {
  std::ranges::sort(shown);
  shown.erase(std::unique(shown.begin(), shown.end()), shown.end());
  const Indices parents = shown;
  for (std::size_t k = 0; k < most && shown.size() < std::min(most, count); ++k) {
    const auto i = static_cast<std::uint32_t>(count <= most ? k : k * count / most);
    if (!std::ranges::binary_search(parents, i)) shown.push_back(i);
  }
  std::ranges::sort(shown);
}

/// Chooses the particles of frame `f - 1` and ties those of frame `f` to them.
void tie_to_parents(const StoredParticles& stored, std::span<const std::size_t> scans,
                    std::size_t f, std::size_t most, ReplayParticles& particles) {
  ReplayParticles::Frame& before = particles.frames[f - 1];
  Indices parents;
  if (!stored.ancestor.empty()) {
    for (const std::uint32_t i : particles.frames[f].shown) {
      parents.push_back(ancestor_at(stored, scans[f], scans[f - 1], i));
    }
  }
  before.shown = parents;
  fill_up(before.shown, stored.count, most);
  for (const std::uint32_t parent : parents) {
    const auto place = std::ranges::lower_bound(before.shown, parent) - before.shown.begin();
    particles.frames[f].parent.push_back(static_cast<std::uint32_t>(place));
  }
}

}  // namespace

ReplayParticles thin_particles(const StoredParticles& stored, std::span<const std::size_t> scans,
                               std::size_t most) {
  ReplayParticles particles{stored.count, std::vector<ReplayParticles::Frame>(scans.size())};
  if (scans.empty()) return particles;
  fill_up(particles.frames.back().shown, stored.count, most);
  for (std::size_t f = scans.size() - 1; f > 0; --f) {
    tie_to_parents(stored, scans, f, most, particles);
  }
  for (std::size_t f = 0; f < scans.size(); ++f) {
    for (const std::uint32_t i : particles.frames[f].shown) {
      const double* pose = stored.pose.data() + 3 * (scans[f] * stored.count + i);
      particles.frames[f].x.push_back(pose[0]);
      particles.frames[f].y.push_back(pose[1]);
    }
  }
  return particles;
}

}  // namespace montecarta::analysis
