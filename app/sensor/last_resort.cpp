#include "sensor/last_resort.hpp"

namespace binpick::app {

LastResort::LastResort(std::function<void()> call, std::chrono::milliseconds after)
    : call_(std::move(call)), after_(after) {
  if (call_) thread_ = std::thread([this] { watch(); });
}

LastResort::~LastResort() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void LastResort::begin() {
  {
    const std::lock_guard lock(mutex_);
    if (busy_) return;
    busy_ = true;
    ++turn_;
    begun_ = std::chrono::steady_clock::now();
  }
  changed_.notify_all();
}

void LastResort::end() {
  std::unique_lock lock(mutex_);
  if (!busy_) return;
  busy_ = false;
  changed_.notify_all();
  changed_.wait(lock, [&] { return !calling_; });
}

void LastResort::watch() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return quit_ || busy_; });
    if (quit_) return;
    const std::uint64_t turn = turn_;
    const auto over = [&] { return quit_ || !busy_ || turn_ != turn; };
    if (changed_.wait_until(lock, begun_ + after_, over)) continue;
    calling_ = true;
    lock.unlock();
    call_();
    lock.lock();
    calling_ = false;
    changed_.notify_all();
    changed_.wait(lock, over);  // once is enough
  }
}

}  // namespace binpick::app
