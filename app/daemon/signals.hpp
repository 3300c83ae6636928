// Signals as something to read, for the main loop. Thread: main.
#pragma once

#include <csignal>

namespace binpick::app {

class SignalInbox {
 public:
  // SIGTERM, SIGINT and SIGHUP no longer interrupt: to be called before any thread is made, which
  // then inherits it.
  static void block();
  // Throws SetupError.
  SignalInbox();
  ~SignalInbox();
  SignalInbox(const SignalInbox&) = delete;
  SignalInbox& operator=(const SignalInbox&) = delete;

  int descriptor() const { return descriptor_; }
  // The next one; 0: none is waiting.
  int take();

 private:
  int descriptor_ = -1;
};

}  // namespace binpick::app
