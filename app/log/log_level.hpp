// How much is said.
#pragma once

namespace binpick::app {

enum class LogLevel : int { kError = 0, kWarning, kInfo, kDebug };

}  // namespace binpick::app
