#include "file_frame.hpp"

#include <unzip.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <pugixml.hpp>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "binpick/train/errors.hpp"
#include "mesh_reader.hpp"
#include "solid_import.hpp"

namespace binpick::train {
namespace {

constexpr double kMetre_mm = 1000, kCentimetre_mm = 10;

// Axes of the file, as seen by who looks at the part from the front.
struct Axes {
  aiVector3D right, up;
};
const Axes kZUp{{1, 0, 0}, {0, 0, 1}};
const Axes kYUp{{1, 0, 0}, {0, 1, 0}};
const Axes kXUp{{0, -1, 0}, {1, 0, 0}};

// Never a reflection: the third axis follows from the two.
aiMatrix4x4 turn_to_z_up(const Axes& axes) {
  const aiVector3D &x = axes.right, &z = axes.up, y = z ^ x;
  return {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, 0, 0, 0, 1};
}

double some_length(double mm) {
  if (!(mm > 0 && std::isfinite(mm))) throw ImportError("its unit has no length");
  return mm;
}

double millimetres_in(const std::string& unit) {
  constexpr struct {
    const char* name;
    double mm;
  } kNamedUnits[] = {{"millimeter", 1},
                     {"millimeters", 1},
                     {"micron", 0.001},
                     {"centimeter", 10},
                     {"meter", kMetre_mm},
                     {"inch", 25.4},
                     {"foot", 304.8},
                     {"feet", 304.8},
                     {"", 1}};  // both 3MF and AMF: millimetres when nothing is said
  for (const auto& known : kNamedUnits) {
    if (unit == known.name) return known.mm;
  }
  throw ImportError("its unit '" + unit + "' is not known");
}

// A file within a zip archive.
std::string entry_of_zip(const std::string& path, const std::string& name) {
  constexpr int kAnyCase = 2;
  const std::unique_ptr<std::remove_pointer_t<unzFile>, decltype(&unzClose)> zip(
      unzOpen64(path.c_str()), &unzClose);
  if (!zip || unzLocateFile(zip.get(), name.c_str(), kAnyCase) != UNZ_OK ||
      unzOpenCurrentFile(zip.get()) != UNZ_OK) {
    throw ImportError("there is no " + name + " in it");
  }
  std::string bytes(std::size_t{1} << 20, '\0'), content;
  int count = 0;
  while ((count = unzReadCurrentFile(zip.get(), bytes.data(),
                                     static_cast<unsigned>(bytes.size()))) > 0) {
    content.append(bytes, 0, static_cast<std::size_t>(count));
  }
  if (count < 0) throw ImportError(name + " in it cannot be unpacked");
  return content;
}

pugi::xml_document xml_of(const std::string& text, const char* name) {
  pugi::xml_document document;
  if (const auto result = document.load_buffer(text.data(), text.size()); !result) {
    throw ImportError(std::string(name) + " is no XML: " + result.description());
  }
  return document;
}

double unit_of_3mf(const std::string& path) {
  std::string model = "3D/3dmodel.model";
  const pugi::xml_document relations = xml_of(entry_of_zip(path, "_rels/.rels"), "_rels/.rels");
  for (const pugi::xml_node relation : relations.child("Relationships")) {
    const std::string type = relation.attribute("Type").as_string();
    if (type.ends_with("/3dmodel")) model = relation.attribute("Target").as_string();
  }
  model.erase(0, std::min(model.find_first_not_of('/'), model.size()));
  return millimetres_in(
      xml_of(entry_of_zip(path, model), "its model").child("model").attribute("unit").as_string());
}

pugi::xml_document xml_file(const std::string& path) {
  pugi::xml_document document;
  if (const auto result = document.load_file(path.c_str()); !result) {
    throw ImportError(std::string("it is no XML: ") + result.description());
  }
  return document;
}

double unit_of_amf(const std::string& path) {
  std::string unit = xml_file(path).child("amf").attribute("unit").as_string();
  std::transform(unit.begin(), unit.end(), unit.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return millimetres_in(unit);
}

Axes axes_of_collada(std::string name) {
  std::erase_if(name, [](unsigned char c) { return std::isspace(c) != 0; });
  if (name == "X_UP") return kXUp;
  if (name == "Y_UP" || name.empty()) return kYUp;
  if (name == "Z_UP") return kZUp;
  throw ImportError("its up_axis '" + name + "' is not known");
}

// Without <unit> metres, without <up_axis> y, as the standard has it.
std::pair<double, Axes> frame_of_collada(const std::string& path) {
  const pugi::xml_document document = xml_file(path);
  const pugi::xml_node asset = document.child("COLLADA").child("asset");
  const double metres = asset.child("unit").attribute("meter").as_double(1);
  return {some_length(metres * kMetre_mm),
          axes_of_collada(asset.child("up_axis").text().as_string())};
}

aiVector3D axis_of_fbx(const aiMetadata& settings, const std::string& name) {
  int index = -1, sign = 1;
  settings.Get(name, index);
  settings.Get(name + "Sign", sign);
  if (index < 0 || index > 2) throw ImportError("its " + name + " is none of 0, 1, 2");
  aiVector3D axis;
  axis[static_cast<unsigned>(index)] = sign < 0 ? -1.0f : 1.0f;
  return axis;
}

std::pair<double, Axes> frame_of_fbx(const aiScene& scene) {
  if (scene.mMetaData == nullptr) throw ImportError("it has no GlobalSettings");
  const Axes axes{axis_of_fbx(*scene.mMetaData, "CoordAxis"),
                  axis_of_fbx(*scene.mMetaData, "UpAxis")};
  if ((axes.up ^ axes.right).SquareLength() == 0) {
    throw ImportError("its CoordAxis and its UpAxis are the same");
  }
  float centimetres = 1;
  scene.mMetaData->Get("UnitScaleFactor", centimetres);
  return {some_length(static_cast<double>(centimetres) * kCentimetre_mm), axes};
}

}  // namespace

FileFrame apply_file_frame(const std::string& path, aiScene& scene) {
  const std::string extension = extension_of(path);
  aiMatrix4x4& T_root = scene.mRootNode->mTransformation;
  FileFrame frame;
  Axes axes = kZUp;
  if (extension == "dae") {
    std::tie(frame.mm_per_unit, axes) = frame_of_collada(path);
    T_root = aiMatrix4x4();  // held assimp's scale and rotation, nothing else
  } else if (extension == "fbx") {
    std::tie(frame.mm_per_unit, axes) = frame_of_fbx(scene);
  } else if (extension == "gltf" || extension == "glb") {
    frame.mm_per_unit = kMetre_mm;  // by the standard, as the axes
    axes = kYUp;
  } else if (holds_solids(path)) {
    frame.mm_per_unit = 1;  // as binpick-cad makes it
  } else if (extension == "3mf") {
    frame.mm_per_unit = unit_of_3mf(path);
  } else if (extension == "amf") {
    frame.mm_per_unit = unit_of_amf(path);
  }
  frame.turned = !(axes.up == kZUp.up);
  // What assimp has turned to y up is turned back, and is in metres where it made metres of it.
  const bool in_metres = extension == "zae" || extension == "ifc";
  if (in_metres) frame.mm_per_unit = kMetre_mm;
  if (in_metres || extension == "3ds" || extension == "ase" || extension == "dxf") axes = kYUp;
  T_root = turn_to_z_up(axes) * T_root;
  return frame;
}

}  // namespace binpick::train
