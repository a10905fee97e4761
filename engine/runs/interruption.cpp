// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/interruption.hpp"

#include "engine/errors.hpp"

#include <cstdlib>
#include <unistd.h>

namespace montecarta::engine {
namespace {

// Globals, because a signal handler has access to nothing else.
std::atomic<int> received{0};
std::atomic<bool> installed{false};
std::atomic<bool> repeats_terms{false};
static_assert(std::atomic<int>::is_always_lock_free, "a handler may not wait for a lock");

extern "C" void note_signal(int signal) {
  int none = 0;
  if (received.compare_exchange_strong(none, signal)) return;
  if (signal == SIGTERM && repeats_terms) return;
  _exit(128 + signal);
}

}  // namespace

bool runs_under_scheduler() { return std::getenv("SLURM_JOB_ID") != nullptr; }

Interruption::Interruption(From from) {
  expect(!installed.exchange(true), "two interruptions at once");
  repeats_terms = from == From::scheduler;
  received = 0;
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = SA_RESTART;  // reads and writes are not interrupted
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, &before_int_);
  sigaction(SIGTERM, &action, &before_term_);
}

Interruption::~Interruption() {
  sigaction(SIGINT, &before_int_, nullptr);
  sigaction(SIGTERM, &before_term_, nullptr);
  installed = false;
}

int Interruption::signal() const { return received; }

StopReason Interruption::reason() const {
  if (signal() == 0) return StopReason::complete;
  return signal() == SIGINT ? StopReason::sigint : StopReason::sigterm;
}

}  // namespace montecarta::engine
