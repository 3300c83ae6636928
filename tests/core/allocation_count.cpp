#include "allocation_count.hpp"

#include <elf.h>
#include <fcntl.h>
#include <link.h>
#include <sys/auxv.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <new>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define BINPICK_COUNTS_ALLOCATIONS 1
#endif

namespace binpick {
namespace {

// Made before the first thread that allocates.
ThreadAllocations table_of_process[kThreadsCounted];
std::atomic<ThreadAllocations*> table{table_of_process};

// Not in memory that is made when it is first used: that would be an allocation.
#define THREAD_OWN __attribute__((tls_model("initial-exec"))) thread_local
THREAD_OWN AllocationCounts of_this_thread;

#ifdef BINPICK_COUNTS_ALLOCATIONS

THREAD_OWN ThreadAllocations* entry = nullptr;

// Where the program's own code lies; shared libraries lie elsewhere. Before it is known everything
// counts as a library's.
std::uintptr_t code_begin = 0, code_end = 0;

ThreadAllocations* claim_entry() {
  ThreadAllocations* threads = table.load(std::memory_order_acquire);
  const std::int64_t tid = syscall(SYS_gettid);
  for (int i = 0; i < kThreadsCounted - 1; ++i) {
    std::int64_t free = 0;
    if (threads[i].tid.compare_exchange_strong(free, tid)) return &threads[i];
  }
  threads[kThreadsCounted - 1].tid = -1;
  return &threads[kThreadsCounted - 1];
}

void count(const void* caller) {
  if (entry == nullptr) entry = claim_entry();
  const auto at = reinterpret_cast<std::uintptr_t>(caller);
  const bool own = at >= code_begin && at < code_end;
  ++(own ? of_this_thread.own : of_this_thread.others);
  (own ? entry->own : entry->others).fetch_add(1, std::memory_order_relaxed);
}

void find_code() {
  const auto* headers = reinterpret_cast<const ElfW(Phdr)*>(getauxval(AT_PHDR));
  const std::size_t number = getauxval(AT_PHNUM);
  std::uintptr_t base = 0;
  for (std::size_t i = 0; i < number; ++i) {
    if (headers[i].p_type == PT_PHDR)
      base = reinterpret_cast<std::uintptr_t>(headers) - headers[i].p_vaddr;
  }
  for (std::size_t i = 0; i < number; ++i) {
    if (headers[i].p_type != PT_LOAD || (headers[i].p_flags & PF_X) == 0) continue;
    code_begin = base + headers[i].p_vaddr;
    code_end = code_begin + headers[i].p_memsz;
  }
}

__attribute__((constructor)) void set_up() {
  find_code();
  const char* file = std::getenv("BINPICK_ALLOCATIONS");
  if (file == nullptr) return;
  const int fd = open(file, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  constexpr std::size_t kBytes = sizeof table_of_process;
  void* shared = MAP_FAILED;
  if (fd >= 0 && ftruncate(fd, kBytes) == 0)
    shared = mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (fd >= 0) close(fd);
  if (shared == MAP_FAILED) std::abort();
  table.store(static_cast<ThreadAllocations*>(shared), std::memory_order_release);
  entry = nullptr;  // what came before is start-up's
}

#endif

}  // namespace

bool allocations_counted() {
#ifdef BINPICK_COUNTS_ALLOCATIONS
  return true;
#else
  return false;
#endif
}

AllocationCounts allocations_of_this_thread() {
  return of_this_thread;
}

AllocationCounts allocations_of_all_threads() {
  AllocationCounts sum;
  const ThreadAllocations* threads = table.load(std::memory_order_acquire);
  for (int i = 0; i < kThreadsCounted; ++i) {
    sum.own += threads[i].own.load(std::memory_order_relaxed);
    sum.others += threads[i].others.load(std::memory_order_relaxed);
  }
  return sum;
}

long long allocation_count() {
  const AllocationCounts sum = allocations_of_all_threads();
  return sum.own + sum.others;
}

}  // namespace binpick

#ifdef BINPICK_COUNTS_ALLOCATIONS

extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t items, std::size_t bytes);
void* __libc_realloc(void* block, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);

void* malloc(std::size_t bytes) {
  binpick::count(__builtin_return_address(0));
  return __libc_malloc(bytes);
}
void* calloc(std::size_t items, std::size_t bytes) {
  binpick::count(__builtin_return_address(0));
  return __libc_calloc(items, bytes);
}
void* realloc(void* block, std::size_t bytes) {
  binpick::count(__builtin_return_address(0));
  return __libc_realloc(block, bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) {
  binpick::count(__builtin_return_address(0));
  return __libc_memalign(alignment, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  binpick::count(__builtin_return_address(0));
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) {
  binpick::count(__builtin_return_address(0));
  *block = __libc_memalign(alignment, bytes);
  return *block != nullptr ? 0 : ENOMEM;
}
}

// The shared C++ library's would make its own calls of malloc look like everybody's.
void* operator new(std::size_t bytes) {
  binpick::count(__builtin_return_address(0));
  if (void* block = __libc_malloc(bytes)) return block;
  throw std::bad_alloc();
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  binpick::count(__builtin_return_address(0));
  if (void* block = __libc_memalign(static_cast<std::size_t>(alignment), bytes)) return block;
  throw std::bad_alloc();
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
