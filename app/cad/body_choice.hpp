// Which of a file's bodies is the part.
#pragma once

#include <string>
#include <vector>

#include "cad/solid_file.hpp"

namespace binpick::cad {

// One line a body: number, name, size.
std::vector<std::string> list_of(const std::vector<Body>& bodies);

// `choice` is a body's name, its number from 1, "all", or empty where there is but one. Of a
// product that an assembly has several times the first is taken. Throws CadError, which lists the
// bodies, where the choice fits none, or several that are not the same.
TopoDS_Shape choose_body(const std::vector<Body>& bodies, const std::string& choice);

}  // namespace binpick::cad
