// What the programs' exit status tells a script and the service manager.
#pragma once

namespace binpick::app {

// 78 is EX_CONFIG: trying again with the same input is useless, and the unit does not.
enum ExitStatus : int { kDone = 0, kFailure = 1, kUsage = 2, kCannotStart = 78 };

}  // namespace binpick::app
