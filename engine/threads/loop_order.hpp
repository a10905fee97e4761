// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#ifdef MONTECARTA_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace montecarta::engine {

/// Tells the thread sanitizer what libtbb and libgomp, which are built without it, keep from it: a
/// loop's bodies begin after the loop does and end before it ends. Bodies stay unordered among each
/// other, so races between them are found. Without the sanitizer all this is nothing.
/// `body` is the loop's body, whose address tells one loop from another.
#ifdef MONTECARTA_THREAD_SANITIZER

class LoopOrder {
 public:
  explicit LoopOrder(const void* body) : body_(body) { __tsan_release(begin()); }
  ~LoopOrder() { __tsan_acquire(end()); }
  LoopOrder(const LoopOrder&) = delete;
  LoopOrder& operator=(const LoopOrder&) = delete;

  /// Around one call of the body.
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

}  // namespace montecarta::engine
