// SPDX-License-Identifier: BSD-3-Clause
#include "engine/threads/in_order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace montecarta::engine {
namespace {

class InOrder : public testing::TestWithParam<Backend> {
 protected:
  Parallel parallel{GetParam(), 3};
};

TEST_P(InOrder, TakesEveryResultInItsTurnAndHoldsFew) {
  for (const std::size_t count : {0, 1, 2, 50}) {
    std::atomic<std::size_t> held = 0, most = 0;
    std::vector<std::size_t> taken;
    const auto make = [&](std::size_t i) {
      const std::size_t now = ++held;
      for (std::size_t seen = most; now > seen && !most.compare_exchange_weak(seen, now);) continue;
      if (i % 7 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
      return i * i;
    };
    for_each_in_order(parallel, count, make, [&](std::size_t i, std::size_t result) {
      EXPECT_EQ(result, i * i);
      taken.push_back(i);
      --held;
    });
    std::vector<std::size_t> wanted(count);
    for (std::size_t i = 0; i < count; ++i) wanted[i] = i;
    EXPECT_EQ(taken, wanted);
    EXPECT_LE(most, 6U);
  }
}

TEST_P(InOrder, RethrowsTheExceptionOfTheLeastIndex) {
  std::vector<std::size_t> taken;
  const auto make = [](std::size_t i) {
    if (i == 5) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (i >= 5) throw std::runtime_error("body " + std::to_string(i));
    return i;
  };
  const auto take = [&](std::size_t i, std::size_t) { taken.push_back(i); };
  EXPECT_THAT([&] { for_each_in_order(parallel, 100, make, take); },
              testing::ThrowsMessage<std::runtime_error>("body 5"));
  EXPECT_THAT(taken, testing::ElementsAre(0, 1, 2, 3, 4));
}

TEST_P(InOrder, RethrowsWhatTakingThrew) {
  const auto make = [](std::size_t i) { return i; };
  const auto take = [](std::size_t i, std::size_t) {
    if (i == 2) throw std::runtime_error("taking 2");
  };
  EXPECT_THAT([&] { for_each_in_order(parallel, 100, make, take); },
              testing::ThrowsMessage<std::runtime_error>("taking 2"));
}

std::string name_of_backend(const testing::TestParamInfo<Backend>& backend) {
  if (backend.param == Backend::serial) return "serial";
  return backend.param == Backend::tbb ? "tbb" : "openmp";
}

INSTANTIATE_TEST_SUITE_P(Backends, InOrder,
                         testing::Values(Backend::serial, Backend::tbb, Backend::openmp),
                         name_of_backend);

}  // namespace
}  // namespace montecarta::engine
