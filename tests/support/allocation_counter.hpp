// SPDX-License-Identifier: Apache-2.0
#pragma once

// Counts every allocation of a test program: by new, by malloc (Eigen's way), in whatever library. Include
// it in one source of the program: it replaces malloc and its kin, on which operator new stands.
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <new>

#include <Eigen/Core>
#include <gtest/gtest.h>
#include <malloc.h>

namespace gatefly::test {

/// Allocations of this thread. constinit: malloc is called before anything is initialised.
inline constinit thread_local long allocations = 0;

/// While it lives, nothing may be allocated. Where Eigen was built to say so (the asan preset), it
/// stops at the very line.
class NothingAllocated {
 public:
  NothingAllocated() : before_{allocations} { let_eigen_allocate(false); }
  ~NothingAllocated() {
    const long counted = allocations - before_;
    let_eigen_allocate(true);
    EXPECT_EQ(counted, 0);
  }
  NothingAllocated(const NothingAllocated&) = delete;
  NothingAllocated& operator=(const NothingAllocated&) = delete;

 private:
  static void let_eigen_allocate([[maybe_unused]] bool allowed) {
#ifdef EIGEN_RUNTIME_NO_MALLOC
    Eigen::internal::set_is_malloc_allowed(allowed);
#endif
  }
  long before_;
};

/// A count of zero says something only when the counter counts.
inline void expect_that_allocations_are_counted() {
  long before = allocations;
  operator delete(operator new(8));
  EXPECT_GT(allocations, before) << "new";
  before = allocations;
  volatile Eigen::Index size = 20;  // the compiler shall not see through it
  const Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(size, size);
  EXPECT_GT(allocations, before) << "Eigen";
  before = allocations;
  const Eigen::MatrixXd product = matrix * matrix.transpose();
  EXPECT_GT(allocations, before) << "Eigen's temporaries";
  EXPECT_EQ(product, matrix);
}

}  // namespace gatefly::test

#ifdef __SANITIZE_ADDRESS__

// malloc is the sanitizer's, but it tells. From <sanitizer/allocator_interface.h>, which GCC 12 has
// not.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void*,
                                                                             std::size_t),
                                                         void (*free_hook)(const volatile void*));

namespace gatefly::test {
inline const int kHooks = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { ++allocations; }, [](const volatile void*) {});
}  // namespace gatefly::test

#else

// The GNU C library's own names for what it puts behind malloc; free stays as it is.
extern "C" {
void* __libc_malloc(std::size_t size) noexcept;
void* __libc_calloc(std::size_t count, std::size_t size) noexcept;
void* __libc_realloc(void* old, std::size_t size) noexcept;
void* __libc_memalign(std::size_t align, std::size_t size) noexcept;

void* malloc(std::size_t size) noexcept {
  ++gatefly::test::allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++gatefly::test::allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) noexcept {
  ++gatefly::test::allocations;
  return __libc_realloc(old, size);
}
void* memalign(std::size_t align, std::size_t size) noexcept {
  ++gatefly::test::allocations;
  return __libc_memalign(align, size);
}
void* aligned_alloc(std::size_t align, std::size_t size) noexcept { return memalign(align, size); }
int posix_memalign(void** out, std::size_t align, std::size_t size) noexcept {
  void* p = memalign(align, size);
  if (p == nullptr) return ENOMEM;
  *out = p;
  return 0;
}
}

#endif
