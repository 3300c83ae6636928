#include "daemon/thread_setup.hpp"

#include <malloc.h>
#include <pthread.h>

#include <cstring>

#include "setup_error.hpp"

namespace binpick::app {
namespace {

int policy_of(Scheduling scheduling) {
  switch (scheduling) {
    case Scheduling::kFifo:
      return SCHED_FIFO;
    case Scheduling::kRoundRobin:
      return SCHED_RR;
    case Scheduling::kOther:
      break;
  }
  return SCHED_OTHER;
}

}  // namespace

ScopedScheduling::ScopedScheduling(const ThreadsConfig& config) : required_(config.required) {
  pthread_getaffinity_np(pthread_self(), sizeof cpus_before_, &cpus_before_);
  pthread_getschedparam(pthread_self(), &policy_before_, &priority_before_);
  if (!config.cpus.empty()) {
    cpu_set_t cpus;
    CPU_ZERO(&cpus);
    for (const int cpu : config.cpus) CPU_SET(static_cast<std::size_t>(cpu), &cpus);
    if (const int error = pthread_setaffinity_np(pthread_self(), sizeof cpus, &cpus))
      refuse("threads.cpus", error, "processors that are there and allowed: CPUAffinity=");
  }
  if (config.scheduling == Scheduling::kOther) return;
  sched_param priority{};
  priority.sched_priority = config.priority;
  const int policy = policy_of(config.scheduling);
  if (const int error = pthread_setschedparam(pthread_self(), policy, &priority))
    refuse("threads.scheduling", error, "LimitRTPRIO= or CAP_SYS_NICE, and RestrictRealtime=no");
}

void ScopedScheduling::refuse(const char* key, int error, const char* needed) {
  const std::string text =
      std::string(key) + ": the system refuses it: " + std::strerror(error) + " (" + needed + ")";
  if (required_) throw SetupError(text);
  refused_ += (refused_.empty() ? "" : "; ") + text;
}

ScopedScheduling::~ScopedScheduling() {
  pthread_setaffinity_np(pthread_self(), sizeof cpus_before_, &cpus_before_);
  pthread_setschedparam(pthread_self(), policy_before_, &priority_before_);
}

void set_up_threads_and_heap(const ThreadsConfig& config) {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  const int refused =
      pthread_attr_setstacksize(&attributes, static_cast<std::size_t>(config.stack_kib) << 10);
  const bool set = refused == 0 && pthread_setattr_default_np(&attributes) == 0;
  pthread_attr_destroy(&attributes);
  if (!set) throw SetupError("threads.stack_kib: the system does not take it");
  mallopt(M_ARENA_MAX, 2);
  // Frames that a recording's reader decodes come and go: not as mappings of their own each time.
  mallopt(M_MMAP_THRESHOLD, 64 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
}

}  // namespace binpick::app
