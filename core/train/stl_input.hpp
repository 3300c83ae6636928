// An STL file before assimp sees it: assimp takes the text of half a part for a part, and knows
// neither upper-case keywords nor bytes behind the last facet.
#pragma once

#include <string>

namespace binpick::train {

// Throws ImportError with the fault alone. Else changes the bytes to what assimp reads as they are
// meant; what was left out is named in one sentence without its full stop, or none.
std::string complete_stl(std::string& bytes);

}  // namespace binpick::train
