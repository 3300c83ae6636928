// Why a CAD file gives no mesh: one sentence for people, which names the fault and not the file.
#pragma once

#include <stdexcept>

namespace binpick::cad {

struct CadError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace binpick::cad
