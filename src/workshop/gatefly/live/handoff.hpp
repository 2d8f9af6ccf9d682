// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <vector>

// Queues between two threads. All memory is allocated at the start, and no thread waits for a lock.

namespace gatefly::live {

/// A queue with one thread that pushes and one that pops.
template <class T>
class Ring {
 public:
  explicit Ring(std::size_t room) : cells_(room + 1) {}

  /// False, and nothing changed, when it is full.
  bool push(const T& value) {
    const std::size_t at = pushed_.load(std::memory_order_relaxed), next = after(at);
    if (next == popped_.load(std::memory_order_acquire)) return false;
    cells_[at] = value;
    pushed_.store(next, std::memory_order_release);
    return true;
  }
  /// The oldest, to be looked at by who pops; nullptr when there is none.
  [[nodiscard]] const T* front() const {
    const std::size_t at = popped_.load(std::memory_order_relaxed);
    return at == pushed_.load(std::memory_order_acquire) ? nullptr : &cells_[at];
  }
  void pop() {
    const std::size_t at = popped_.load(std::memory_order_relaxed);
    if (at != pushed_.load(std::memory_order_acquire))
      popped_.store(after(at), std::memory_order_release);
  }

 private:
  [[nodiscard]] std::size_t after(std::size_t at) const {
    return at + 1 == cells_.size() ? 0 : at + 1;
  }

  std::vector<T> cells_;
  alignas(64) std::atomic<std::size_t> pushed_ = 0;
  alignas(64) std::atomic<std::size_t> popped_ = 0;
};

/// The last value that one thread wrote, for one that reads: three places, of which each thread has one and the third changes hands.
template <class T>
class Latest {
 public:
  void write(const T& value) {
    cells_[back_] = value;
    back_ = middle_.exchange(back_ | kNew, std::memory_order_acq_rel) & kPlace;
  }
  /// T{} before the first was written; valid until the next call.
  [[nodiscard]] const T& read() {
    if ((middle_.load(std::memory_order_relaxed) & kNew) != 0)
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kPlace;
    return cells_[front_];
  }

 private:
  static constexpr unsigned kNew = 4, kPlace = 3;
  std::array<T, 3> cells_{};
  unsigned back_ = 0, front_ = 1;
  std::atomic<unsigned> middle_ = 2;
};

}  // namespace gatefly::live
