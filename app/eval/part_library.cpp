#include "eval/part_library.hpp"

namespace binpick::app {

PartLibrary load_parts(const drivers::BopDataset& dataset, const std::set<int>& obj_ids) {
  PartLibrary parts;
  const std::map<int, drivers::BopModel> models = dataset.models();
  for (const int obj_id : obj_ids) {
    const auto model = models.find(obj_id);
    if (model == models.end()) {
      throw drivers::DatasetError(dataset.root() +
                                  "/models/models_info.json: has no entry for object " +
                                  std::to_string(obj_id));
    }
    // The layout prescribes millimetres.
    parts[obj_id] = {model->second,
                     train::import_mesh(model->second.mesh_path, train::LengthUnit::kMillimetre)};
  }
  return parts;
}

std::map<int, PartGeometry> geometry_of(const PartLibrary& parts) {
  std::map<int, PartGeometry> geometry;
  for (const auto& [obj_id, part] : parts)
    geometry.emplace(obj_id, PartGeometry(part.model, part.imported.mesh));
  return geometry;
}

}  // namespace binpick::app
