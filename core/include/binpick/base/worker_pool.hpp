// The threads that core may use. Core starts none: the program hands in a pool.
#pragma once

namespace binpick {

class WorkerPool {
 public:
  virtual ~WorkerPool() = default;
  // Number of threads that run tasks, the calling one included; at least 1.
  virtual int thread_count() const = 0;

  // Runs task(index, thread) for every index in [0, count), in any order, on any of the threads,
  // and returns when all are done. `thread` is in [0, thread_count()) and no two tasks run at once
  // with the same value, so it may choose a scratch buffer. Results must not depend on it.
  template <class Task>
  void parallel_for(int count, Task&& task) {
    run(count, &trampoline<Task>, &task);
  }

 protected:
  using TaskFn = void (*)(void* context, int index, int thread);
  virtual void run(int count, TaskFn fn, void* context) = 0;

 private:
  template <class Task>
  static void trampoline(void* context, int index, int thread) {
    (*static_cast<Task*>(context))(index, thread);
  }
};

// Runs everything on the calling thread.
class SerialPool final : public WorkerPool {
 public:
  int thread_count() const override { return 1; }

 protected:
  void run(int count, TaskFn fn, void* context) override {
    for (int i = 0; i < count; ++i) fn(context, i, 0);
  }
};

}  // namespace binpick
