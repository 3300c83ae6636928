// The parts of a data set: what models_info.json says of each, its mesh, and its geometry for
// scoring.
#pragma once

#include <map>
#include <set>

#include "binpick/drivers/bop_dataset.hpp"
#include "binpick/train/mesh.hpp"
#include "eval/part_geometry.hpp"

namespace binpick::app {

struct Part {
  drivers::BopModel model;
  train::ImportedMesh imported;
};

using PartLibrary = std::map<int, Part>;  // by object id

// Reads the meshes of these objects. Throws DatasetError for an object without an entry,
// ImportError for a mesh that cannot be used.
PartLibrary load_parts(const drivers::BopDataset& dataset, const std::set<int>& obj_ids);

std::map<int, PartGeometry> geometry_of(const PartLibrary& parts);

}  // namespace binpick::app
