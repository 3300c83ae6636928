#include "parts.hpp"

#include <cctype>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "mesh_files.hpp"

namespace binpick::simulation {
namespace {

namespace fs = std::filesystem;

// The number of a name like obj_000004, or 0.
int id_from_name(const std::string& stem) {
  if (stem.rfind("obj_", 0) != 0 || stem.size() < 5 || stem.size() > 12) return 0;
  for (std::size_t i = 4; i < stem.size(); ++i) {
    if (std::isdigit(static_cast<unsigned char>(stem[i])) == 0) return 0;
  }
  return std::stoi(stem.substr(4));
}

void read_symmetries(const fs::path& info_path, Part& part) {
  std::ifstream in(info_path);
  if (!in) return;
  const auto all = nlohmann::json::parse(in);
  const auto info = all.find(std::to_string(part.obj_id));
  if (info == all.end()) return;
  for (const auto& row_major : info->value("symmetries_discrete", nlohmann::json::array())) {
    Pose pose;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) pose.R(r, c) = row_major.at(r * 4 + c).get<double>();
      pose.t_mm[r] = row_major.at(r * 4 + 3).get<double>();
    }
    part.symmetries.push_back(pose);
  }
  for (const auto& symmetry : info->value("symmetries_continuous", nlohmann::json::array())) {
    const auto& axis = symmetry.at("axis");
    part.symmetry_axes.emplace_back(axis.at(0).get<double>(), axis.at(1).get<double>(),
                                    axis.at(2).get<double>());
  }
}

}  // namespace

std::vector<Part> make_own_parts() {
  Pose half_turn;
  half_turn.R = Vec3(-1, -1, 1).asDiagonal();
  std::vector<Part> parts(3);
  parts[0] = {1, "tee", make_tee(), {half_turn}, {}, Finish::kCastBrass};
  parts[1] = {2, "clip", make_clip(), {}, {}, Finish::kGalvanised};
  parts[2] = {3, "hub", make_hub(), {}, {}, Finish::kMachined};
  for (const auto& part : parts) {
    if (!is_closed(part.mesh)) throw std::logic_error("the mesh of " + part.name + " has a gap");
  }
  return parts;
}

std::vector<Part> read_parts(const std::vector<std::string>& paths) {
  constexpr std::array kFinishes = {Finish::kMachined, Finish::kPlastic, Finish::kCastBrass,
                                    Finish::kGalvanised};
  std::vector<Part> parts;
  std::set<int> ids;
  for (const auto& text : paths) {
    const fs::path path(text);
    Part part;
    part.name = path.stem().string();
    part.mesh = text == "bolt" ? make_bolt() : read_mesh(text);
    part.obj_id = id_from_name(part.name);
    if (part.obj_id == 0) part.obj_id = static_cast<int>(parts.size()) + 1;
    if (!ids.insert(part.obj_id).second) {
      throw std::runtime_error(text + " has the same object id as a mesh before it");
    }
    part.finish = kFinishes[static_cast<std::size_t>(part.obj_id) % kFinishes.size()];
    read_symmetries(path.parent_path() / "models_info.json", part);
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace binpick::simulation
