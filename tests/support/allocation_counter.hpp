// SPDX-License-Identifier: Apache-2.0
#pragma once

// Counts every allocation of a test program. Include it in one source of the program: it replaces
// operator new.
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

namespace gatefly::test {

inline std::atomic<long> allocations{0};

/// A count of zero says something only when the counter counts.
inline void expect_that_allocations_are_counted() {
  const long before = allocations;
  operator delete(operator new(8));
  EXPECT_GT(allocations, before) << "the counter counts";
}

}  // namespace gatefly::test

// GCC takes aligned_alloc for another family than malloc; both are freed by free(). Not inlined: it
// would warn about new meeting free().
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

[[gnu::noinline]] void* operator new(std::size_t size) {
  ++gatefly::test::allocations;
  if (void* p = std::malloc(size != 0 ? size : 1)) return p;
  throw std::bad_alloc{};
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t align) {
  ++gatefly::test::allocations;
  const auto a = static_cast<std::size_t>(align);
  if (void* p = std::aligned_alloc(a, (size + a - 1) / a * a)) return p;
  throw std::bad_alloc{};
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}
