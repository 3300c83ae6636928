// The worker threads that core and training are handed: a fixed set, started once, woken for each
// parallel_for. The calling thread takes part as thread 0, so a pool of one thread starts none.
// After construction nothing here allocates. Thread: one parallel_for at a time, from any one
// thread; calling it from inside a task of the same pool is a programmer's error.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "binpick/base/worker_pool.hpp"

namespace binpick::app {

class ThreadPool final : public WorkerPool {
 public:
  explicit ThreadPool(int threads);
  ~ThreadPool() override;
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int thread_count() const override { return static_cast<int>(workers_.size()) + 1; }

 protected:
  // The first exception that a task throws leaves here, after every running task has ended; tasks
  // that have not begun by then are not begun.
  void run(int count, TaskFn fn, void* context) override;

 private:
  void work(int thread);
  void take_tasks(int thread);
  void stop_workers();

  std::mutex mutex_;
  std::condition_variable job_opened_;
  std::condition_variable workers_left_;
  // Guarded by mutex_. fn_, context_ and count_ are also read without it by whoever joined the job:
  // they change only while nobody has.
  bool stopping_ = false;
  bool job_open_ = false;
  std::uint64_t job_number_ = 0;
  int workers_in_job_ = 0;
  std::exception_ptr failure_;
  TaskFn fn_ = nullptr;
  void* context_ = nullptr;
  int count_ = 0;

  std::atomic<int> next_{0};
  std::vector<std::thread> workers_;
};

// What --threads means when it is not given: every processor that the machine has.
int default_thread_count();

}  // namespace binpick::app
