// SPDX-License-Identifier: BSD-3-Clause
#include "engine/threads/parallel.hpp"

#include "engine/errors.hpp"

#include <omp.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <exception>

namespace montecarta::engine {
namespace {

using Call = void (*)(const void*, std::size_t);

void spread_in_arena(std::size_t count, Call call, const void* body) {
  tbb::parallel_for(std::size_t{0}, count, [=](std::size_t i) { call(body, i); });
}

bool inside_a_task() { return tbb::task::current_context() != nullptr; }

/// Keeps the first exception of a body, since no exception may leave an OpenMP region.
class FirstException {
 public:
  bool caught() const { return taken_.load(std::memory_order_relaxed); }
  void catch_current() {
    if (!taken_.exchange(true)) exception_ = std::current_exception();
  }
  void rethrow() const {
    if (exception_) std::rethrow_exception(exception_);
  }

 private:
  std::atomic<bool> taken_{false};
  std::exception_ptr exception_;
};

void spread_openmp(int threads, std::size_t count, Call call, const void* body) {
  // A loop inside the body of another stays on its thread, since nested teams would oversubscribe
  // the machine.
  if (omp_in_parallel() != 0) threads = 1;
  const auto team = static_cast<std::size_t>(threads);
  const std::size_t chunk = std::max<std::size_t>(1, count / (8 * team));
  FirstException first;
#pragma omp parallel for schedule(dynamic, chunk) num_threads(threads)
  for (std::size_t i = 0; i < count; ++i) {
    if (first.caught()) continue;
    try {
      call(body, i);
    } catch (...) {
      first.catch_current();
    }
  }
  first.rethrow();
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
  if (backend_ == Backend::openmp) return spread_openmp(threads_, count, call, body);
  pool_->arena.execute([=] {
    if (!inside_a_task()) return spread_in_arena(count, call, body);
    // While a thread waits for an inner loop, it must not take another body of the outer one.
    tbb::this_task_arena::isolate([=] { spread_in_arena(count, call, body); });
  });
}

}  // namespace montecarta::engine
