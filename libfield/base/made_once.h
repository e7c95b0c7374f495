// A value that is made when it is first asked for, by whichever thread that is.
#pragma once

#include <atomic>
#include <memory>

namespace cs2mesh {

/// Safe to use from any number of threads. Unlike std::call_once, nobody waits and the system is
/// not called: threads that come at the same time each make one, and keep the first.
template <class T>
class MadeOnce {
 public:
  MadeOnce() = default;
  MadeOnce(const MadeOnce&) = delete;
  MadeOnce& operator=(const MadeOnce&) = delete;
  ~MadeOnce() { delete made_.load(std::memory_order_relaxed); }

  /// `make` returns the same T whenever it is called; it lives as long as this.
  template <class Make>
  const T& get(const Make& make) const {
    const T* found = made_.load(std::memory_order_acquire);
    if (found != nullptr) return *found;
    auto mine = std::make_unique<const T>(make());
    const bool first = made_.compare_exchange_strong(found, mine.get(), std::memory_order_acq_rel,
                                                     std::memory_order_acquire);
    return first ? *mine.release() : *found;
  }

 private:
  mutable std::atomic<const T*> made_ = nullptr;
};

}  // namespace cs2mesh
