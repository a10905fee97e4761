// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

namespace montecarta::experiments {

/// A process beside ours that outlives us by a moment: when we are gone, killed perhaps, it kills
/// the process groups that are still guarded. It listens to a socket whose other end nobody but we
/// hold, so it cannot miss our end. (A parent-death signal would follow the thread that started a
/// program.) Any number of threads may use it.
class OrphanGuard {
 public:
  /// The one of this process, started by the first call.
  static OrphanGuard& instance();
  OrphanGuard(const OrphanGuard&) = delete;
  OrphanGuard& operator=(const OrphanGuard&) = delete;

  void guard(pid_t group) const { tell(group); }
  /// To be called before the group's leader is waited for: its number may be another's afterwards.
  void release(pid_t group) const { tell(-group); }

 private:
  OrphanGuard();
  ~OrphanGuard() = default;  // the socket is closed when the process ends
  void tell(pid_t signed_group) const;

  int line_ = -1;  ///< -1: the system has no process left to give, and nothing is guarded
};

}  // namespace montecarta::experiments
