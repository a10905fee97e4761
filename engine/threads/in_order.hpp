// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/threads/parallel.hpp"

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <type_traits>
#include <utility>

namespace montecarta::engine {

/// Results that threads make in any order, and that are taken in the order of their index.
template <class Result, class Take>
class TakenInOrder {
 public:
  /// At most `most` results are begun and not yet taken.
  TakenInOrder(std::size_t count, std::size_t most, const Take& take)
      : count_(count), most_(most), take_(&take) {}

  /// Waits for room and returns the index of the next result to make; nullopt if there is none.
  std::optional<std::size_t> begin_next() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return failure_ || begun_ < taken_ + most_; });
    return failure_ || begun_ == count_ ? std::nullopt : std::optional(begun_++);
  }
  /// Takes result `i` and those that waited only for it. If `result` is nullopt, its making threw
  /// `exception`.
  void finish(std::size_t i, std::optional<Result> result, std::exception_ptr exception) {
    const std::lock_guard lock(mutex_);
    try {
      waiting_.emplace(i, Made{std::move(result), std::move(exception)});
      for (; !failure_ && !waiting_.empty() && waiting_.begin()->first == taken_; ++taken_) {
        Made next = std::move(waiting_.extract(waiting_.begin()).mapped());
        if (!next.result) std::rethrow_exception(next.exception);
        (*take_)(taken_, std::move(*next.result));
      }
    } catch (...) {
      failure_ = std::current_exception();
    }
    changed_.notify_all();
  }
  /// Rethrows the exception of the least index. All threads must have ended.
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  struct Made {
    std::optional<Result> result;
    std::exception_ptr exception;
  };

  std::size_t count_, most_;
  const Take* take_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::size_t, Made> waiting_;  ///< results that wait for earlier ones
  std::size_t begun_ = 0, taken_ = 0;
  std::exception_ptr failure_;
};

/// Calls take(i, make(i)) for every i in [0, count): make() on all threads at once, take() in the
/// order of i and one at a time. There are never more than two results for each thread. If several
/// bodies throw, the exception of the least i is rethrown, for any number of threads.
template <class Make, class Take>
void for_each_in_order(const Parallel& parallel, std::size_t count, const Make& make,
                       const Take& take) {
  using Result = std::invoke_result_t<Make, std::size_t>;
  const std::size_t threads = std::min(static_cast<std::size_t>(parallel.threads()), count);
  TakenInOrder<Result, Take> results(count, 2 * threads, take);
  parallel.for_each(threads, [&](std::size_t) {
    while (const std::optional<std::size_t> i = results.begin_next()) {
      std::optional<Result> result;
      std::exception_ptr exception;
      try {
        result.emplace(make(*i));
      } catch (...) {
        exception = std::current_exception();
      }
      results.finish(*i, std::move(result), std::move(exception));
    }
  });
  results.rethrow();
}

}  // namespace montecarta::engine
