// All memory of the cycle: one block, taken piece by piece while the system is set up, sealed
// before it runs. Thread: set-up only; sealed arenas are read-only facts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <type_traits>

#include "binpick/base/assert.hpp"

namespace binpick {

class Arena {
 public:
  static constexpr std::size_t kAlignment = 64;  // a cache line, and the widest vector register

  explicit Arena(std::size_t bytes);
  ~Arena();
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  // `count` zeroed elements, aligned to kAlignment. Asking for more than is left, or after seal(),
  // is a programmer's error: plan with ArenaPlan, the same code path, first.
  template <class T>
  std::span<T> take(std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T>);
    T* p = static_cast<T*>(take_bytes(count * sizeof(T)));
    for (std::size_t i = 0; i < count; ++i) new (p + i) T();
    return {p, count};
  }

  void seal() { sealed_ = true; }
  std::size_t used_bytes() const { return used_bytes_; }
  std::size_t size_bytes() const { return size_bytes_; }

  static constexpr std::size_t padded(std::size_t bytes) {
    return (bytes + kAlignment - 1) / kAlignment * kAlignment;
  }

 private:
  void* take_bytes(std::size_t bytes);

  std::byte* block_ = nullptr;
  std::size_t size_bytes_ = 0;
  std::size_t used_bytes_ = 0;
  bool sealed_ = false;
};

}  // namespace binpick
