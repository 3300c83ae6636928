#include "binpick/base/arena.hpp"

#include <cstring>

namespace binpick {

Arena::Arena(std::size_t bytes) : size_bytes_(padded(bytes)) {
  block_ = static_cast<std::byte*>(::operator new (size_bytes_, std::align_val_t{kAlignment}));
  std::memset(block_, 0, size_bytes_);  // touches every page: nothing is left to fault in later
}

Arena::~Arena() {
  ::operator delete (block_, std::align_val_t{kAlignment});
}

void* Arena::take_bytes(std::size_t bytes) {
  BINPICK_ASSERT(!sealed_);
  const std::size_t needed = padded(bytes);
  BINPICK_ASSERT(needed <= size_bytes_ - used_bytes_);
  std::byte* p = block_ + used_bytes_;
  used_bytes_ += needed;
  return p;
}

}  // namespace binpick
