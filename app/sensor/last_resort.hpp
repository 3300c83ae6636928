// Calls a last resort when work on a lost sensor takes too long: on a dead link every access blocks
// for seconds, and tearing down makes several of them; what frees the link meanwhile ends them all.
// The call is made on a thread of its own, which is there only where there is something to call.
// Thread-safe.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>

namespace binpick::app {

class LastResort {
 public:
  // `call` may be empty: then nothing ever happens. It throws nothing, and does not touch this.
  LastResort(std::function<void()> call, std::chrono::milliseconds after);
  // Waits for a call that is under way.
  ~LastResort();
  LastResort(const LastResort&) = delete;
  LastResort& operator=(const LastResort&) = delete;

  // The sensor is lost, and somebody is still busy with it: unless that ends in time, one call.
  void begin();
  // It has ended. Waits for a call that is under way: what is opened afterwards is not disturbed.
  void end();

 private:
  void watch();

  const std::function<void()> call_;
  const std::chrono::milliseconds after_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool quit_ = false, busy_ = false, calling_ = false;
  std::uint64_t turn_ = 0;  // counts what was begun
  std::chrono::steady_clock::time_point begun_;
  std::thread thread_;  // last: it uses the rest
};

}  // namespace binpick::app
