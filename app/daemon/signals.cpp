#include "daemon/signals.hpp"

#include <sys/signalfd.h>
#include <unistd.h>

#include "setup_error.hpp"

namespace binpick::app {
namespace {

sigset_t wanted() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGHUP);
  return set;
}

}  // namespace

void SignalInbox::block() {
  const sigset_t set = wanted();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

SignalInbox::SignalInbox() {
  const sigset_t set = wanted();
  descriptor_ = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
  if (descriptor_ < 0) throw SetupError("no signal descriptor can be had");
}

SignalInbox::~SignalInbox() {
  close(descriptor_);
}

int SignalInbox::take() {
  signalfd_siginfo info{};
  if (read(descriptor_, &info, sizeof info) != static_cast<ssize_t>(sizeof info)) return 0;
  return static_cast<int>(info.ssi_signo);
}

}  // namespace binpick::app
