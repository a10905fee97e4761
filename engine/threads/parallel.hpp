// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <atomic>
#include <cstddef>
#include <memory>

#ifdef MONTECARTA_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif
namespace montecarta::engine {

/// Declares to the thread sanitizer the order that it cannot see in libtbb and libgomp, which are
/// built without it: the bodies of a loop begin after the loop does and end before it ends. Bodies
/// stay unordered among each other, so races between them are found. Without the sanitizer this
/// does nothing. The address of `body` identifies a loop.
#ifdef MONTECARTA_THREAD_SANITIZER

class LoopOrder {
 public:
  explicit LoopOrder(const void* body) : body_(body) { __tsan_release(begin()); }
  ~LoopOrder() { __tsan_acquire(end()); }
  LoopOrder(const LoopOrder&) = delete;
  LoopOrder& operator=(const LoopOrder&) = delete;

  /// Encloses one call of the body.
  class Call {
   public:
    explicit Call(const void* body) : body_(body) { __tsan_acquire(LoopOrder::begin(body_)); }
    ~Call() { __tsan_release(LoopOrder::end(body_)); }
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;

   private:
    const void* body_;
  };

 private:
  void* begin() const { return begin(body_); }
  void* end() const { return end(body_); }
  static void* begin(const void* body) { return const_cast<void*>(body); }
  static void* end(const void* body) { return static_cast<char*>(begin(body)) + 1; }

  const void* body_;
};

#else

struct LoopOrder {
  explicit LoopOrder(const void* /*body*/) {}
  struct Call {
    explicit Call(const void* /*body*/) {}
  };
};

#endif

enum class Backend { tbb, openmp, serial };

/// Distributes the bodies of a loop over threads. Bodies write disjoint memory and are not ordered,
/// so results do not depend on the backend or the number of threads. Copies share one pool, and a
/// loop inside the body of another uses the same threads, so never more than `threads()` are
/// active.
class Parallel {
 public:
  /// `threads` >= 1; the serial backend ignores it.
  Parallel(Backend backend, int threads);
  /// Runs loops on the calling thread.
  static const Parallel& serial();

  Backend backend() const { return backend_; }
  int threads() const { return backend_ == Backend::serial ? 1 : threads_; }

  /// Calls body(i) once for every i in [0, count). If bodies throw, the exception of the least i is
  /// rethrown, on any number of threads.
  template <class Body>
  void for_each(std::size_t count, const Body& body) const {
    if (threads() == 1 || count < 2) {
      for (std::size_t i = 0; i < count; ++i) call_body<Body>(&body, i);
      return;
    }
    const LoopOrder order(&body);
    const auto call_inside = [](const void* erased, std::size_t i) {
      const LoopOrder::Call inside(erased);
      call_body<Body>(erased, i);
    };
    spread(count, call_inside, &body);
  }

 private:
  /// The only compiled copy of a body: bodies are large, and two would take twice the compile time.
  template <class Body>
  [[gnu::noinline, gnu::noclone]] static void call_body(const void* body, std::size_t i) {
    (*static_cast<const Body*>(body))(i);
  }

  struct Pool;
  void spread(std::size_t count, void (*call)(const void*, std::size_t), const void* body) const;

  Backend backend_;
  int threads_;
  std::shared_ptr<Pool> pool_;  ///< threads of TBB; nullptr without TBB or with one thread
};

/// Lends threads that have no run of their own to the loops inside runs that are still active: if
/// there are fewer runs than threads, and at the end of every study.
class SpareThreads {
 public:
  /// Number of particles below which it costs more to distribute a loop than it saves.
  static constexpr std::size_t kLeastParticles = 256;

  SpareThreads(const Parallel& parallel, std::size_t workers)
      : parallel_(&parallel), at_work_(workers) {}

  /// The threads for the next loop over `particles`. They may change with the step; results do not.
  const Parallel& lend(std::size_t particles) const {
    const auto threads = static_cast<std::size_t>(parallel_->threads());
    const bool spare = at_work_.load(std::memory_order_relaxed) < threads;
    return spare && particles >= kLeastParticles ? *parallel_ : Parallel::serial();
  }
  /// Records that a worker has no more runs.
  void gain_one() { at_work_.fetch_sub(1, std::memory_order_relaxed); }

 private:
  const Parallel* parallel_;
  std::atomic<std::size_t> at_work_;
};

}  // namespace montecarta::engine
