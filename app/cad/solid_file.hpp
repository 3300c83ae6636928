// What a STEP or IGES file holds, in mm, each body where its assembly puts it.
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

namespace binpick::cad {

struct Body {
  std::string name;  // of its product or its own; may be empty, need not be unique
  TopoDS_Shape shape;
};

// The solids, in the order of the file; a file of mere surfaces is one body, sewn where they meet.
// Throws CadError, or what OpenCASCADE throws on its way through a hostile file.
std::vector<Body> read_bodies(const std::string& path);

}  // namespace binpick::cad
