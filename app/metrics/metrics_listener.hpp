// The socket that metrics are asked at.
#pragma once

#include <string>

namespace binpick::app {

struct MetricsListener {
  int fd = -1;
  int port = 0;             // 0: a Unix socket
  std::string socket_path;  // to be removed at the end
};

// `listen` as MetricsServerParams says. Throws SetupError that names it.
MetricsListener open_metrics_listener(const std::string& listen);

}  // namespace binpick::app
