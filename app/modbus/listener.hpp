// A listening TCP socket, and what each accepted one is set to.
#pragma once

#include <string>

#include "modbus/owned_fd.hpp"

namespace binpick::modbus {

struct Listener {
  OwnedFd fd;
  int port = 0;  // the one it got, when any was asked for
};

// Throws app::SetupError naming address, port and the system's reason.
Listener listen_on(const std::string& bind_address, int port);

// No delay, and a peer that died without a word is noticed after about ten seconds.
void tune_client_socket(int fd);

}  // namespace binpick::modbus
