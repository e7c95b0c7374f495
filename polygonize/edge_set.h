// A set of pairs of vertices.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cs2mesh {

/// Open addressing with linear probing. A pair of different vertices has no direction. Any number
/// of threads may insert at once, and any number may ask at once, but not both.
class EdgeSet {
 public:
  /// Room for `count` edges without growing.
  explicit EdgeSet(std::size_t count) : slots_(std::bit_ceil(2 * count + 2), kFree) {}

  bool contains(std::uint32_t a, std::uint32_t b) const {
    const std::uint64_t key = key_of(a, b);
    for (std::size_t i = place(key);; i = next(i)) {
      if (slots_[i] == key) return true;
      if (slots_[i] == kFree) return false;
    }
  }
  /// No more than `count` different ones in all.
  void insert(std::uint32_t a, std::uint32_t b) {
    const std::uint64_t key = key_of(a, b);
    for (std::size_t i = place(key);; i = next(i)) {
      const std::atomic_ref<std::uint64_t> slot(slots_[i]);
      std::uint64_t held = slot.load(std::memory_order_relaxed);
      if (held == kFree) slot.compare_exchange_strong(held, key, std::memory_order_relaxed);
      if (held == kFree || held == key) return;
    }
  }

 private:
  static constexpr std::uint64_t kFree = ~std::uint64_t{0};
  static std::uint64_t key_of(std::uint32_t a, std::uint32_t b) {
    return (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
  }
  std::size_t place(std::uint64_t key) const {
    // Fibonacci hashing: the high bits of the product are well mixed.
    const std::uint64_t mixed = key * 0x9e3779b97f4a7c15U;
    return static_cast<std::size_t>(mixed >> 20) & (slots_.size() - 1);
  }
  std::size_t next(std::size_t i) const { return (i + 1) & (slots_.size() - 1); }

  std::vector<std::uint64_t> slots_;
};

}  // namespace cs2mesh
