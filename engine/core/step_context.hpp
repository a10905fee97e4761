// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"
#include "engine/random/stream.hpp"
#include "engine/threads/parallel.hpp"

#include <cstddef>
#include <cstdint>

namespace montecarta::engine {

/// Whether somebody has asked the workers to stop. For a filter that waits for something outside of
/// the process; any other ends its step soon enough.
class StopFlag {
 public:
  virtual ~StopFlag() = default;
  virtual bool is_set() const = 0;
};

/// What the engine gives a filter for one step: its place in the study, random streams, and
/// threads.
class StepContext {
 public:
  StepContext(std::uint64_t seed, std::uint64_t run, std::uint32_t step, const Parallel& parallel,
              const StopFlag* stop = nullptr)
      : seed_(seed), run_(run), step_(step), parallel_(&parallel), stop_(stop) {}

  std::uint64_t run() const { return run_; }
  std::uint32_t step() const { return step_; }
  /// The numbers of (study seed, run, step, purpose, index): the same wherever and whenever asked
  /// for.
  RngStream stream(Draw purpose, std::uint32_t index) const {
    return RngStream(identity(purpose, index));
  }
  StreamIdentity identity(Draw purpose, std::uint32_t index) const {
    return {seed_, run_, step_, index, purpose};
  }
  /// Valid for the whole run; nullptr where nobody stops it. What a filter throws after it was made
  /// is no result: the run is dropped.
  const StopFlag* stop() const { return stop_; }
  /// Calls body(i) for i in [0, count), perhaps at once; body i may write only what belongs to i.
  template <class Body>
  void parallel_for(std::size_t count, const Body& body) const {
    parallel_->for_each(count, body);
  }

 private:
  std::uint64_t seed_;
  std::uint64_t run_;
  std::uint32_t step_;
  const Parallel* parallel_;
  const StopFlag* stop_;
};

}  // namespace montecarta::engine
