// A worker pool that starts its threads for each call: slow, and simple enough to be trusted by
// tests.
#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "binpick/base/worker_pool.hpp"

namespace binpick {

class ThreadsPerCall final : public WorkerPool {
 public:
  explicit ThreadsPerCall(int thread_count) : thread_count_(thread_count) {}
  int thread_count() const override { return thread_count_; }

 protected:
  void run(int count, TaskFn fn, void* context) override {
    std::atomic<int> next{0};
    const auto work = [&](int thread) {
      for (int i = next++; i < count; i = next++) fn(context, i, thread);
    };
    std::vector<std::thread> threads;
    for (int t = 1; t < thread_count_; ++t) threads.emplace_back(work, t);
    work(0);
    for (std::thread& t : threads) t.join();
  }

 private:
  int thread_count_;
};

}  // namespace binpick
