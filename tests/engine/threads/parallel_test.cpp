// SPDX-License-Identifier: BSD-3-Clause
#include "engine/threads/parallel.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <barrier>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace montecarta::engine {
namespace {

struct Choice {
  Backend backend;
  int threads;
};

class EveryParallel : public testing::TestWithParam<Choice> {
 protected:
  Parallel parallel{GetParam().backend, GetParam().threads};
};

TEST_P(EveryParallel, CallsEachBodyOnce) {
  for (const std::size_t count : {0, 1, 2, 7, 1000}) {
    std::vector<int> calls(count, 0);
    parallel.for_each(count, [&](std::size_t i) { ++calls[i]; });
    EXPECT_THAT(calls, testing::Each(1)) << count << " bodies";
  }
}

TEST_P(EveryParallel, GivesTheSameBitsNested) {
  std::vector<std::vector<double>> sums(5, std::vector<double>(300));
  parallel.for_each(sums.size(), [&](std::size_t i) {
    parallel.for_each(sums[i].size(), [&, i](std::size_t j) {
      sums[i][j] = 1.0 / static_cast<double>(i + 3 * j + 1);
    });
  });
  for (std::size_t i = 0; i < sums.size(); ++i)
    for (std::size_t j = 0; j < sums[i].size(); ++j)
      EXPECT_EQ(sums[i][j], 1.0 / static_cast<double>(i + 3 * j + 1));
}

/// A thread that took up another outer body while it waits for its inner loop, the last body of
/// which another thread is at, would be in two outer bodies at once.
TEST_P(EveryParallel, KeepsAnOuterBodyOnItsThreadAlone) {
  static thread_local int depth = 0;
  std::atomic<int> deepest{0};
  parallel.for_each(40, [&](std::size_t i) {
    if (++depth > deepest) deepest = depth;
    parallel.for_each(i % 8 == 0 ? 16 : 2, [](std::size_t j) {
      std::this_thread::sleep_for(std::chrono::microseconds(50 * (1 + j % 4)));
    });
    --depth;
  });
  EXPECT_EQ(deepest, 1);
}

TEST_P(EveryParallel, NeverUsesMoreThreadsThanItsOwn) {
  std::atomic<int> working{0};
  std::atomic<int> most{0};
  parallel.for_each(16, [&](std::size_t) {
    parallel.for_each(64, [&](std::size_t) {
      const int now = ++working;
      for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) continue;
      --working;
    });
  });
  EXPECT_LE(most, parallel.threads());
}

TEST_P(EveryParallel, RethrowsWhatABodyThrewInAnInnerLoopToo) {
  const auto throws_at_3 = [](std::size_t i) {
    if (i == 3) throw std::runtime_error("body 3");
  };
  EXPECT_THAT([&] { parallel.for_each(100, throws_at_3); },
              testing::ThrowsMessage<std::runtime_error>("body 3"));
  const auto outer = [&](std::size_t) {
    parallel.for_each(10, [](std::size_t) { throw std::runtime_error("inner"); });
  };
  EXPECT_THAT([&] { parallel.for_each(4, outer); },
              testing::ThrowsMessage<std::runtime_error>("inner"));
}

TEST_P(EveryParallel, RethrowsTheExceptionOfTheLeastIndex) {
  std::atomic<bool> has_thrown = false;
  const auto throws_from_3_on = [&](std::size_t i) {
    if (i < 3) return;
    // The body that counts is late, if another thread is there to be earlier.
    const int patience = parallel.threads() > 1 ? 100'000 : 0;
    for (int k = 0; i == 3 && !has_thrown && k < patience; ++k) std::this_thread::yield();
    has_thrown = i > 3;
    throw std::runtime_error("body " + std::to_string(i));
  };
  EXPECT_THAT([&] { parallel.for_each(100, throws_from_3_on); },
              testing::ThrowsMessage<std::runtime_error>("body 3"));
}

std::string name_of(const testing::TestParamInfo<Choice>& choice) {
  const char* backends[] = {"tbb", "openmp", "serial"};
  return backends[static_cast<int>(choice.param.backend)] + std::to_string(choice.param.threads);
}

INSTANTIATE_TEST_SUITE_P(Backends, EveryParallel,
                         testing::Values(Choice{Backend::serial, 1}, Choice{Backend::tbb, 1},
                                         Choice{Backend::tbb, 2}, Choice{Backend::tbb, 8},
                                         Choice{Backend::openmp, 1}, Choice{Backend::openmp, 2},
                                         Choice{Backend::openmp, 8}),
                         name_of);

/// All bodies must be at work at once to pass the barrier, even beyond the number of processors.
TEST(Parallel, WorkersMeetAtABarrier) {
  for (const Backend backend : {Backend::tbb, Backend::openmp}) {
    const Parallel parallel(backend, 4);
    std::barrier all_here(4);
    parallel.for_each(4, [&](std::size_t) { all_here.arrive_and_wait(); });
  }
}

TEST(Parallel, HasOneThreadAtLeast) {
  EXPECT_EQ(Parallel(Backend::serial, 8).threads(), 1);
  EXPECT_EQ(Parallel::serial().threads(), 1);
  EXPECT_THROW(Parallel(Backend::tbb, 0), std::logic_error);
}

}  // namespace
}  // namespace montecarta::engine
