// A PLY file before assimp sees it: assimp waits for ever for the end of a header, takes what there
// is of a text that was cut short, and loses the first byte of binary data when it is a line feed.
#pragma once

#include <string>

namespace binpick::train {

// Throws ImportError with the fault alone: no header, or less data than the header announces. Else
// changes the bytes to what assimp reads as they are meant.
void complete_ply(std::string& bytes);

}  // namespace binpick::train
