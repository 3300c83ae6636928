// Where and how threads run: what is set here is inherited by the threads made meanwhile, and put
// back at the end of the scope. Set-up only.
#pragma once

#include <sched.h>

#include <string>

#include "config/config.hpp"

namespace binpick::app {

// Where the system does not allow it: throws SetupError if it is required, and else goes on with
// what is allowed.
class ScopedScheduling {
 public:
  explicit ScopedScheduling(const ThreadsConfig& config);
  ~ScopedScheduling();
  ScopedScheduling(const ScopedScheduling&) = delete;
  ScopedScheduling& operator=(const ScopedScheduling&) = delete;

  // What the system refused, for a person; empty: nothing.
  const std::string& refused() const { return refused_; }

 private:
  void refuse(const char* key, int error, const char* needed);

  const bool required_;
  std::string refused_;
  cpu_set_t cpus_before_{};
  int policy_before_ = 0;
  sched_param priority_before_{};
};

// Stack of the threads made from here on, and few heaps, so that what the process holds stays flat.
void set_up_threads_and_heap(const ThreadsConfig& config);

}  // namespace binpick::app
