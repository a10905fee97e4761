// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "engine/numbers/real.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace montecarta::engine {

/// Number of blocks of kLanesOf<Real> lanes for `particles`; lanes without a particle are called
/// dead.
template <class Real>
constexpr std::size_t blocks_for(std::size_t particles) {
  return (particles + kLanesOf<Real> - 1) / kLanesOf<Real>;
}

/// Allocates memory for elements that are written before they are read. Threads that share this
/// work then also share that of the system, for which the first touch of memory is slow.
template <class T>
struct UntouchedAllocator : std::allocator<T> {
  template <class U>
  struct rebind {  // NOLINT(readability-identifier-naming): a name of the standard's
    using other = UntouchedAllocator<U>;  // NOLINT(readability-identifier-naming)
  };
  template <class U>
  void construct(U* /*element*/) const noexcept {}
  template <class U, class... Arguments>
  void construct(U* element, Arguments&&... arguments) const {
    std::construct_at(element, std::forward<Arguments>(arguments)...);
  }
};
template <class T>
using UntouchedColumn = std::vector<T, UntouchedAllocator<T>>;

/// A column of one Real per block as one double per particle, with the dead lanes at the end.
template <class Real>
std::span<double> scalars(std::vector<Real>& column) {
  return {reinterpret_cast<double*>(column.data()), column.size() * kLanesOf<Real>};
}
template <class Real>
std::span<const double> scalars(const std::vector<Real>& column) {
  return {reinterpret_cast<const double*>(column.data()), column.size() * kLanesOf<Real>};
}

/// A struct of Reals as an array of numbers: field f of particle i is at offset(i) + f *
/// kLanesOf<Real>.
template <class Real, class Block>
struct BlockLayout {
  static_assert(sizeof(Block) % sizeof(Real) == 0);
  // NOLINTNEXTLINE(bugprone-sizeof-expression): a block may be a single number
  static constexpr std::size_t kFields = sizeof(Block) / sizeof(Real);
  static constexpr std::size_t offset(std::size_t particle) {
    constexpr std::size_t lanes = kLanesOf<Real>;
    return particle / lanes * kFields * lanes + particle % lanes;
  }
};

/// Returns block b of a population in which particle i is a copy of particle source[i] of `from`.
template <class Real, class Block>
Block gather_block(std::span<const Block> from, std::span<const std::uint32_t> source,
                   std::size_t b) {
  using Layout = BlockLayout<Real, Block>;
  constexpr std::size_t lanes = kLanesOf<Real>;
  const double* numbers = reinterpret_cast<const double*>(from.data());
  Block block;
  double* out = reinterpret_cast<double*>(&block);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const double* particle = numbers + Layout::offset(source[b * lanes + lane]);
    for (std::size_t f = 0; f < Layout::kFields; ++f) out[f * lanes + lane] = particle[f * lanes];
  }
  return block;
}

/// Copies the numbers of one particle from one block to the same lane of another.
template <class Real, class Block>
void copy_lane(const Block& from, Block& to, std::size_t lane) {
  constexpr std::size_t fields = BlockLayout<Real, Block>::kFields;
  const double* in = reinterpret_cast<const double*>(&from);
  double* out = reinterpret_cast<double*>(&to);
  for (std::size_t f = 0; f < fields; ++f) {
    out[f * kLanesOf<Real> + lane] = in[f * kLanesOf<Real> + lane];
  }
}

/// Distributes the blocks of a population over tasks that may run in parallel.
template <class Real>
class BlockTasks {
 public:
  /// `per_task` is a number of blocks. A thread does not pay off for fewer than 256 particles of
  /// usual work.
  explicit BlockTasks(std::size_t blocks, std::size_t per_task = 256 / kLanesOf<Real>)
      : blocks_(blocks), per_task_(per_task) {}

  std::size_t count() const { return (blocks_ + per_task_ - 1) / per_task_; }

  /// Calls body(task, block) for every block, in order within a task.
  template <class Body>
  void run(const StepContext& context, const Body& body) const {
    context.parallel_for(count(), [&](std::size_t task) {
      const std::size_t end = std::min(blocks_, (task + 1) * per_task_);
      for (std::size_t b = task * per_task_; b < end; ++b) body(task, b);
    });
  }
  /// Calls body(first, n) for the n blocks of every task.
  template <class Body>
  void run_together(const StepContext& context, const Body& body) const {
    context.parallel_for(count(), [&](std::size_t task) {
      const std::size_t first = task * per_task_;
      body(first, std::min(blocks_ - first, per_task_));
    });
  }

 private:
  std::size_t blocks_, per_task_;
};

/// Makes `to` the population in which particle i is a copy of particle source[i] of `from`.
template <class Real, class Block>
void gather(const StepContext& context, const std::vector<Block>& from,
            std::span<const std::uint32_t> source, std::vector<Block>& to) {
  BlockTasks<Real>(to.size()).run(context, [&](std::size_t /*task*/, std::size_t b) {
    to[b] = gather_block<Real, Block>(from, source, b);
  });
}

/// Number of particles whose terms are added one after the other. The sum over a larger population
/// adds the sums of parts of this size in the order of the parts.
inline constexpr std::size_t kParticlesPerSum = 1024;

/// Joins the parts of a population in their order: join(whole, part) for every part after the
/// first. part_of(first, n) computes a part from n blocks of at most kParticlesPerSum particles.
template <class Real, class PartOf, class Join>
auto joined_parts(const StepContext& context, std::size_t blocks, const PartOf& part_of,
                  const Join& join) {
  using Part = decltype(part_of(blocks, blocks));
  constexpr std::size_t per_part = kParticlesPerSum / kLanesOf<Real>;
  const BlockTasks<Real> tasks(blocks, per_part);
  Part whole{};  // no memory is allocated for a population of one part
  std::vector<Part> more(tasks.count() - 1);
  tasks.run_together(context, [&](std::size_t first, std::size_t n) {
    (first == 0 ? whole : more[first / per_part - 1]) = part_of(first, n);
  });
  for (const Part& part : more) join(whole, part);
  return whole;
}
/// The sum of numbers over a population; sum_of(first, n) adds up those of n blocks.
template <class Real, class SumOf>
double sum_of_parts(const StepContext& context, std::size_t blocks, const SumOf& sum_of) {
  return joined_parts<Real>(context, blocks, sum_of, [](double& sum, double part) { sum += part; });
}

}  // namespace montecarta::engine
