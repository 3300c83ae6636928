// Which cycles are written to the disk.
#pragma once

namespace binpick::app {

enum class RecordMode : int {
  kOnCommand = 0,  // what is in memory when write_kept() is called
  kOnFault,        // and what is in memory when a cycle fails
  kAlways,         // every cycle
};

}  // namespace binpick::app
