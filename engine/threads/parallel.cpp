// SPDX-License-Identifier: BSD-3-Clause
#include "engine/threads/parallel.hpp"

#include "engine/errors.hpp"

#include <omp.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>

namespace montecarta::engine {
namespace {

/// The bodies of one loop. It keeps the exception of the least index: all bodies before that are
/// called on any number of threads; those after it need not be called.
class Bodies {
 public:
  using Call = void (*)(const void*, std::size_t);

  Bodies(Call function, const void* body) : call_(function), body_(body) {}

  void call(std::size_t i) {
    if (i > failed_.load(std::memory_order_relaxed)) return;
    try {
      call_(body_, i);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (i > failed_.load(std::memory_order_relaxed)) return;
      failed_.store(i, std::memory_order_relaxed);
      exception_ = std::current_exception();
    }
  }
  /// Rethrows the exception. Must be called after all calls have returned. The lock is for the
  /// thread sanitizer, which does not see that TBB and OpenMP join their threads.
  void rethrow() {
    const std::lock_guard lock(mutex_);
    if (exception_) std::rethrow_exception(exception_);
  }

 private:
  Call call_;
  const void* body_;
  std::atomic<std::size_t> failed_{std::numeric_limits<std::size_t>::max()};
  std::mutex mutex_;
  std::exception_ptr exception_;
};

void spread_in_arena(std::size_t count, Bodies& bodies) {
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { bodies.call(i); });
}

bool inside_a_task() { return tbb::task::current_context() != nullptr; }

void spread_openmp(int threads, std::size_t count, Bodies& bodies) {
  // A loop inside the body of another stays on its thread, since nested teams would oversubscribe
  // the machine.
  if (omp_in_parallel() != 0) threads = 1;
  const auto team = static_cast<std::size_t>(threads);
  const std::size_t chunk = std::max<std::size_t>(1, count / (8 * team));
#pragma omp parallel for schedule(dynamic, chunk) num_threads(threads)
  for (std::size_t i = 0; i < count; ++i) bodies.call(i);
}

}  // namespace

/// The limit lets TBB start as many threads as requested, even more than there are processors.
struct Parallel::Pool {
  explicit Pool(int threads)
      : limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads)),
        arena(threads) {}
  tbb::global_control limit;
  tbb::task_arena arena;
};

Parallel::Parallel(Backend backend, int threads) : backend_(backend), threads_(threads) {
  expect(threads >= 1, "a loop needs at least one thread");
  if (backend == Backend::tbb && threads > 1) pool_ = std::make_shared<Pool>(threads);
}

const Parallel& Parallel::serial() {
  static const Parallel calling_thread(Backend::serial, 1);
  return calling_thread;
}

void Parallel::spread(std::size_t count, void (*call)(const void*, std::size_t),
                      const void* body) const {
  Bodies bodies(call, body);
  if (backend_ == Backend::openmp) {
    spread_openmp(threads_, count, bodies);
  } else {
    pool_->arena.execute([&] {
      if (!inside_a_task()) return spread_in_arena(count, bodies);
      // While a thread waits for an inner loop, it must not take another body of the outer one.
      tbb::this_task_arena::isolate([&] { spread_in_arena(count, bodies); });
    });
  }
  bodies.rethrow();
}

}  // namespace montecarta::engine
