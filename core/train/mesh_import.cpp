// From a file's name to a mesh in mm: what the file is, what is in it, in which unit, and in what
// state.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>

#include "binpick/train/errors.hpp"
#include "binpick/train/mesh.hpp"
#include "mesh_clean.hpp"
#include "mesh_import_child.hpp"

namespace binpick::train {
namespace {

constexpr std::int64_t kFileBytesMax = std::int64_t{512} << 20;
constexpr double kExtentMin_mm = 0.5;
constexpr double kExtentMax_mm = 5000;
// No part for a gripper is smaller than this in mm, or larger than this in metres.
constexpr double kMetreExtentMax = 1.0;

std::string length_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

char lower_case(char c) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

std::string extension_of(const std::string& path) {
  const std::size_t dot = path.find_last_of("./");
  if (dot == std::string::npos || path[dot] != '.') return "";
  std::string extension = path.substr(dot + 1);
  std::transform(extension.begin(), extension.end(), extension.begin(), lower_case);
  return extension;
}

// What is no file, or too large a one, is refused before a reader sees it.
std::uint64_t hash_of_file(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) throw ImportError(std::strerror(errno));
  if (!S_ISREG(status.st_mode)) throw ImportError("it is not a file");
  if (status.st_size == 0) throw ImportError("the file is empty");
  if (status.st_size > kFileBytesMax) {
    throw ImportError("the file is larger than " + std::to_string(kFileBytesMax >> 20) + " MiB");
  }
  const auto close_file = [](FILE* file) { std::fclose(file); };
  const std::unique_ptr<FILE, decltype(close_file)> file(std::fopen(path.c_str(), "rbe"),
                                                         close_file);
  if (!file) throw ImportError(std::strerror(errno));
  std::uint64_t hash = 0xcbf29ce484222325;
  std::vector<unsigned char> chunk(std::size_t{1} << 18);
  while (const std::size_t count = std::fread(chunk.data(), 1, chunk.size(), file.get())) {
    for (std::size_t i = 0; i < count; ++i) hash = (hash ^ chunk[i]) * 0x100000001b3;
  }
  if (std::ferror(file.get()) != 0) throw ImportError(std::strerror(errno));
  return hash;
}

void refuse_solid_models(const std::string& path) {
  for (const char* name :
       {"step", "stp", "iges", "igs", "x_t", "sldprt", "ipt", "catpart", "f3d"}) {
    if (extension_of(path) == name) {
      throw ImportError(std::string(name) +
                        " files describe solids, not triangles; export the part " +
                        "as STL or PLY with a tolerance of 0.1 mm or finer");
    }
  }
}

// assimp takes what there is of an STL text that was cut short, and half a part looks like a part.
void refuse_half_stl(const std::string& path) {
  if (extension_of(path) != "stl") return;
  std::ifstream file(path, std::ios::binary);
  char head[84] = "";
  file.read(head, sizeof head);
  std::uint32_t triangles_count = 0;
  std::memcpy(&triangles_count, head + 80, sizeof triangles_count);
  file.clear();
  file.seekg(0, std::ios::end);
  const std::streamoff size = file.tellg();
  const bool binary = size == 84 + 50 * std::streamoff{triangles_count};
  if (binary || std::memcmp(head, "solid", 5) != 0) return;
  file.seekg(std::max<std::streamoff>(0, size - 1000));
  std::string tail(std::istreambuf_iterator<char>(file), {});
  std::transform(tail.begin(), tail.end(), tail.begin(), lower_case);
  if (tail.find("endsolid") == std::string::npos) {
    throw ImportError("the file ends without the word endsolid, so it was cut short");
  }
}

double largest_extent(const Mesh& mesh) {
  Vec3 low = mesh.vertices_mm[0].cast<double>(), high = low;
  for (const Eigen::Vector3f& vertex : mesh.vertices_mm) {
    low = low.cwiseMin(vertex.cast<double>());
    high = high.cwiseMax(vertex.cast<double>());
  }
  return (high - low).maxCoeff();
}

LengthUnit guess_unit(const std::string& path, double extent, std::vector<std::string>& notes) {
  const std::string extension = extension_of(path);
  if (extension == "gltf" || extension == "glb") {
    notes.push_back("Unit not given; metres, as glTF prescribes.");
    return LengthUnit::kMetre;
  }
  const bool metres = extent < kMetreExtentMax;
  notes.push_back(std::string("Unit not given; guessed ") + (metres ? "metres" : "millimetres") +
                  ", since the largest extent is " + length_text(extent) + ".");
  return metres ? LengthUnit::kMetre : LengthUnit::kMillimetre;
}

double millimetres_in(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::kMetre:
      return 1000;
    case LengthUnit::kInch:
      return 25.4;
    case LengthUnit::kGuess:
    case LengthUnit::kMillimetre:
      break;
  }
  return 1;
}

void scale_to_mm(Mesh& mesh, double extent, LengthUnit unit) {
  const double extent_mm = extent * millimetres_in(unit);
  if (!(extent_mm >= kExtentMin_mm && extent_mm <= kExtentMax_mm)) {
    throw ImportError("its largest extent is " + length_text(extent_mm) +
                      " mm and has to be within " + length_text(kExtentMin_mm) + " and " +
                      length_text(kExtentMax_mm) + " mm; is the unit right?");
  }
  for (Eigen::Vector3f& vertex : mesh.vertices_mm) {
    vertex = (vertex.cast<double>() * millimetres_in(unit)).cast<float>();
  }
}

ImportedMesh import_file(const std::string& path, LengthUnit unit) {
  ImportedMesh imported;
  imported.source_hash = hash_of_file(path);
  refuse_solid_models(path);
  refuse_half_stl(path);
  FileContent content = read_in_child(read_with_assimp, path, ChildLimits{});
  if (!content.complaints.empty()) {
    imported.notes.push_back("The reader complains: " + content.complaints + ".");
  }
  if (content.skipped_count > 0) {
    imported.notes.push_back(std::to_string(content.skipped_count) + " points or lines left out.");
  }
  imported.mesh = clean_mesh(std::move(content.mesh), imported.notes);
  const double extent = largest_extent(imported.mesh);
  imported.unit = unit == LengthUnit::kGuess ? guess_unit(path, extent, imported.notes) : unit;
  scale_to_mm(imported.mesh, extent, imported.unit);
  return imported;
}

}  // namespace

ImportedMesh import_mesh(const std::string& path, LengthUnit unit) {
  try {
    return import_file(path, unit);
  } catch (const ImportError& error) {
    throw ImportError("cannot import " + path + ": " + error.what());
  }
}

}  // namespace binpick::train
