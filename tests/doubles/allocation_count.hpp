// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Replaces operator new, so exactly one file of a test program may include this. All forms for one
// object are replaced: memory of a form that is not would be freed by another allocator, where a
// sanitizer has its own.

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace montecarta::engine {

/// The number of allocations of this program so far; tests look at differences.
inline std::atomic<std::size_t> n_allocations{0};

}  // namespace montecarta::engine

// Not inlined: seen from inside, g++ takes malloc and free for a mismatch.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t& /*none*/) noexcept {
  ++montecarta::engine::n_allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment,
                                     const std::nothrow_t& /*none*/) noexcept {
  ++montecarta::engine::n_allocations;
  const auto unit = static_cast<std::size_t>(alignment);
  return std::aligned_alloc(unit, (size + unit - 1) / unit * unit);
}
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  if (void* memory = operator new(size, alignment, std::nothrow)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, const std::nothrow_t& /*none*/) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t,
                                       const std::nothrow_t& /*none*/) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
