// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <utility>

namespace gatefly {

/// A list of at most N values that lives where it is declared: the loop allocates nothing.
template <class T, std::size_t N>
class FixedList {
 public:
  static constexpr std::size_t kCapacity = N;

  /// Appends; false, and nothing changed, when full.
  bool push_back(const T& value) {
    if (size_ == N) return false;
    values_[size_++] = value;
    return true;
  }
  void pop_back() { size_ -= size_ > 0; }  ///< Nothing to take: nothing happens.
  void clear() { size_ = 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] bool full() const { return size_ == N; }
  T& operator[](std::size_t i) { return values_[i]; }
  const T& operator[](std::size_t i) const { return values_[i]; }
  /// The last element; in an empty list the first place, which holds a T{}.
  T& back() { return values_[size_ > 0 ? size_ - 1 : 0]; }
  const T& back() const { return values_[size_ > 0 ? size_ - 1 : 0]; }
  T* begin() { return values_.data(); }
  T* end() { return values_.data() + size_; }
  const T* begin() const { return values_.data(); }
  const T* end() const { return values_.data() + size_; }

 private:
  std::array<T, N> values_{};
  std::size_t size_ = 0;
};

/// Sorts a short list in place, stable: std::sort on so short a list makes compilers warn about its
/// end.
template <class T, std::size_t N, class Before>
void insertion_sort(FixedList<T, N>& list, Before before) {
  for (std::size_t i = 1; i < list.size(); ++i)
    for (std::size_t j = i; j > 0 && before(list[j], list[j - 1]); --j)
      std::swap(list[j], list[j - 1]);
}

}  // namespace gatefly
