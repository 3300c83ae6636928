#include "own_allocations.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define BINPICK_COUNTS_ALLOCATIONS 1
#endif

namespace {

thread_local long long own = 0, others = 0;
std::atomic<long long> own_of_all{0}, others_of_all{0};

}  // namespace

#ifdef BINPICK_COUNTS_ALLOCATIONS

extern "C" {
// The program's code lies between them; shared libraries lie elsewhere.
extern char __executable_start, etext;

void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t items, std::size_t bytes);
void* __libc_realloc(void* block, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
}

namespace {

void count(const void* caller) {
  const auto at = reinterpret_cast<std::uintptr_t>(caller);
  const bool mine = at >= reinterpret_cast<std::uintptr_t>(&__executable_start) &&
                    at < reinterpret_cast<std::uintptr_t>(&etext);
  ++(mine ? own : others);
  (mine ? own_of_all : others_of_all).fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

extern "C" {
void* malloc(std::size_t bytes) {
  count(__builtin_return_address(0));
  return __libc_malloc(bytes);
}
void* calloc(std::size_t items, std::size_t bytes) {
  count(__builtin_return_address(0));
  return __libc_calloc(items, bytes);
}
void* realloc(void* block, std::size_t bytes) {
  count(__builtin_return_address(0));
  return __libc_realloc(block, bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) {
  count(__builtin_return_address(0));
  return __libc_memalign(alignment, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  count(__builtin_return_address(0));
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) {
  count(__builtin_return_address(0));
  *block = __libc_memalign(alignment, bytes);
  return *block != nullptr ? 0 : ENOMEM;
}
}

// The shared C++ library's would make its own calls of malloc look like everybody's.
void* operator new(std::size_t bytes) {
  count(__builtin_return_address(0));
  if (void* block = __libc_malloc(bytes)) return block;
  std::abort();
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  count(__builtin_return_address(0));
  if (void* block = __libc_memalign(static_cast<std::size_t>(alignment), bytes)) return block;
  std::abort();
}
void operator delete(void* block) noexcept {
  std::free(block);
}
void operator delete(void* block, std::size_t) noexcept {
  std::free(block);
}
void operator delete(void* block, std::align_val_t) noexcept {
  std::free(block);
}
void operator delete(void* block, std::size_t, std::align_val_t) noexcept {
  std::free(block);
}

#endif

namespace binpick {

bool allocations_counted() {
#ifdef BINPICK_COUNTS_ALLOCATIONS
  return true;
#else
  return false;
#endif
}

AllocationCounts allocations_of_this_thread() {
  return {own, others};
}

AllocationCounts allocations_of_all_threads() {
  return {own_of_all, others_of_all};
}

}  // namespace binpick
