#include "thread_pool.hpp"

#include <pthread.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <utility>

#include "binpick/base/assert.hpp"

namespace binpick::app {
namespace {

// The pool whose task this thread is running, to notice nested use.
thread_local const ThreadPool* pool_of_this_task = nullptr;

}  // namespace

ThreadPool::ThreadPool(int threads) {
  BINPICK_ASSERT(threads >= 1);
  workers_.reserve(static_cast<std::size_t>(threads) - 1);
  try {
    for (int thread = 1; thread < threads; ++thread) {
      workers_.emplace_back([this, thread] { work(thread); });
    }
  } catch (...) {  // no more threads to be had: let go of those that were
    stop_workers();
    throw;
  }
}

ThreadPool::~ThreadPool() {
  stop_workers();
}

void ThreadPool::stop_workers() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  job_opened_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void ThreadPool::run(int count, TaskFn fn, void* context) {
  BINPICK_ASSERT(pool_of_this_task != this);
  // Each thread takes one index beyond the last before it stops.
  BINPICK_ASSERT(count <= std::numeric_limits<int>::max() - thread_count());
  if (count <= 0) return;
  {
    const std::lock_guard lock(mutex_);
    BINPICK_ASSERT(!job_open_ && workers_in_job_ == 0);
    fn_ = fn;
    context_ = context;
    count_ = count;
    next_.store(0, std::memory_order_relaxed);
    job_open_ = true;
    ++job_number_;
  }
  if (count > 1) job_opened_.notify_all();
  take_tasks(0);
  std::exception_ptr failure;
  {
    // A worker that wakes up only now finds the job closed: nobody waits for it.
    std::unique_lock lock(mutex_);
    job_open_ = false;
    workers_left_.wait(lock, [this] { return workers_in_job_ == 0; });
    failure = std::exchange(failure_, nullptr);
  }
  if (failure) std::rethrow_exception(failure);
}

void ThreadPool::work(int thread) {
  char name[16];
  std::snprintf(name, sizeof name, "worker-%d", thread);
  pthread_setname_np(pthread_self(), name);
  std::uint64_t job_seen = 0;
  std::unique_lock lock(mutex_);
  for (;;) {
    job_opened_.wait(lock, [&] { return stopping_ || (job_open_ && job_number_ != job_seen); });
    if (stopping_) return;
    job_seen = job_number_;
    ++workers_in_job_;
    lock.unlock();
    take_tasks(thread);
    lock.lock();
    if (--workers_in_job_ == 0) workers_left_.notify_one();
  }
}

void ThreadPool::take_tasks(int thread) {
  const ThreadPool* outer = std::exchange(pool_of_this_task, this);
  try {
    for (;;) {
      const int index = next_.fetch_add(1, std::memory_order_relaxed);
      if (index >= count_) break;
      fn_(context_, index, thread);
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::current_exception();
    next_.store(count_, std::memory_order_relaxed);
  }
  pool_of_this_task = outer;
}

int default_thread_count() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace binpick::app
