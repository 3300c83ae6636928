// Who is given the commands that clients start. Called on the server's thread, which serves all
// clients: must neither block nor allocate.
#pragma once

#include "modbus/command.hpp"

namespace binpick::modbus {

class CommandSink {
 public:
  virtual ~CommandSink() = default;
  virtual void put(const TakenCommand& command) = 0;
};

}  // namespace binpick::modbus
