// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/threads/loop_order.hpp"

#include <cstddef>
#include <memory>

namespace montecarta::engine {

enum class Backend { tbb, openmp, serial };

/// How a loop over independent bodies is spread over threads. Bodies write disjoint memory and are
/// not ordered, so results do not depend on the backend or the number of threads. Copies share one
/// pool, and a loop inside a body of another uses the same threads: never more than `threads()` are
/// at work.
class Parallel {
 public:
  /// `threads` >= 1; serial ignores it.
  Parallel(Backend backend, int threads);
  /// For loops that stay on the calling thread.
  static const Parallel& serial();

  Backend backend() const { return backend_; }
  int threads() const { return backend_ == Backend::serial ? 1 : threads_; }

  /// Calls body(i) once for every i in [0, count). The first exception thrown by a body is
  /// rethrown.
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
  /// The one compiled copy of a body: bodies are large, and two would cost the compiler twice.
  template <class Body>
  [[gnu::noinline, gnu::noclone]] static void call_body(const void* body, std::size_t i) {
    (*static_cast<const Body*>(body))(i);
  }

  struct Pool;
  void spread(std::size_t count, void (*call)(const void*, std::size_t), const void* body) const;

  Backend backend_;
  int threads_;
  std::shared_ptr<Pool> pool_;  ///< of TBB; null where the calling thread or OpenMP does the work
};

}  // namespace montecarta::engine
