// Which vector instructions the kernels may use. The operator and the tests can cap it.
#pragma once

#include <string_view>

namespace binpick {

enum class Isa { kBest, kScalar, kSse4, kAvx2, kAvx512 };

// "best", "scalar", "sse4", "avx2", "avx512". Returns false for another name.
bool isa_from_name(std::string_view name, Isa& isa);
const char* isa_name(Isa isa);
// Whether this machine can run it; kBest and kScalar always.
bool isa_supported(Isa isa);

}  // namespace binpick
