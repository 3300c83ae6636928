// From a file's name to a mesh in mm: what the file is, what is in it, in which unit, and in what
// state.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <memory>

#include "binpick/train/errors.hpp"
#include "binpick/train/mesh.hpp"
#include "mesh_clean.hpp"
#include "mesh_import_child.hpp"
#include "solid_import.hpp"

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

void refuse_files_of_cad_programs(const std::string& path) {
  for (const char* name : {"x_t", "x_b", "sldprt", "sldasm", "ipt", "iam", "prt", "catpart", "f3d",
                           "par", "3dm", "fcstd", "dwg", "jt", "sat"}) {
    if (extension_of(path) == name) {
      throw ImportError(std::string(name) +
                        " files are for CAD programs only; export the part as STEP there");
    }
  }
}

void refuse_choice_without_solids(const std::string& path, const SolidChoice& solids) {
  if (holds_solids(path) || (solids.body.empty() && solids.deflection_mm == 0)) return;
  throw ImportError("body and deflection can be chosen of STEP and IGES files only");
}

double largest_extent(const Mesh& mesh) {
  Vec3 low = mesh.vertices_mm[0].cast<double>(), high = low;
  for (const Eigen::Vector3f& vertex : mesh.vertices_mm) {
    low = low.cwiseMin(vertex.cast<double>());
    high = high.cwiseMax(vertex.cast<double>());
  }
  return (high - low).maxCoeff();
}

struct UnitSize {
  LengthUnit unit;
  const char* name;
  double mm;
};
constexpr UnitSize kUnits[] = {
    {LengthUnit::kMillimetre, "mm", 1}, {LengthUnit::kMetre, "m", 1000},
    {LengthUnit::kInch, "inch", 25.4},  {LengthUnit::kCentimetre, "cm", 10},
    {LengthUnit::kFoot, "ft", 304.8},   {LengthUnit::kMicrometre, "um", 0.001}};
constexpr double kSameUnit = 1e-6;  // files keep a unit's size as a float at least

UnitSize size_of(LengthUnit unit) {
  return *std::find_if(std::begin(kUnits), std::end(kUnits),
                       [&](const UnitSize& u) { return u.unit == unit; });
}

UnitSize unit_of_file(double mm) {
  for (const UnitSize& u : kUnits) {
    if (std::abs(mm - u.mm) <= kSameUnit * u.mm) return u;
  }
  return {LengthUnit::kOther, "a unit of its own", mm};
}

// Where the file does not say.
UnitSize guessed_unit(double extent, std::vector<std::string>& notes) {
  const bool metres = extent < kMetreExtentMax;
  notes.push_back(std::string("Unit not given; guessed ") + (metres ? "metres" : "millimetres") +
                  ", since the largest extent is " + length_text(extent) + ".");
  return size_of(metres ? LengthUnit::kMetre : LengthUnit::kMillimetre);
}

UnitSize choose_unit(LengthUnit asked, double file_mm, double extent,
                     std::vector<std::string>& notes) {
  if (file_mm == 0) {
    return asked == LengthUnit::kOfFile ? guessed_unit(extent, notes) : size_of(asked);
  }
  const UnitSize of_file = unit_of_file(file_mm);
  if (asked == LengthUnit::kOfFile || asked == of_file.unit) return of_file;
  const UnitSize chosen = size_of(asked);
  notes.push_back(std::string("The file says that its unit is ") + of_file.name + " (" +
                  length_text(of_file.mm) + " mm); it is taken as " + chosen.name + ", as asked.");
  return chosen;
}

void scale_to_mm(Mesh& mesh, double extent, const UnitSize& unit) {
  const double extent_mm = extent * unit.mm;
  if (!(extent_mm >= kExtentMin_mm && extent_mm <= kExtentMax_mm)) {
    throw ImportError("its largest extent is " + length_text(extent_mm) +
                      " mm and has to be within " + length_text(kExtentMin_mm) + " and " +
                      length_text(kExtentMax_mm) + " mm; is the unit right? It is taken as " +
                      unit.name);
  }
  for (Eigen::Vector3f& vertex : mesh.vertices_mm) {
    vertex = (vertex.cast<double>() * unit.mm).cast<float>();
  }
}

ImportedMesh import_file(const std::string& path, LengthUnit unit, const SolidChoice& solids) {
  ImportedMesh imported;
  imported.source_hash = hash_of_file(path);
  refuse_files_of_cad_programs(path);
  refuse_choice_without_solids(path, solids);
  const auto reader = [&](const std::string& file) { return read_with_assimp(file, solids); };
  FileContent content = read_in_child(reader, path, ChildLimits{});
  if (!content.remarks.empty()) imported.notes.push_back(content.remarks + ".");
  if (content.skipped_count > 0) {
    imported.notes.push_back(std::to_string(content.skipped_count) + " points or lines left out.");
  }
  imported.mesh = clean_mesh(std::move(content.mesh), imported.notes);
  const double extent = largest_extent(imported.mesh);
  const UnitSize chosen = choose_unit(unit, content.mm_per_unit, extent, imported.notes);
  imported.unit = chosen.unit;
  scale_to_mm(imported.mesh, extent, chosen);
  return imported;
}

}  // namespace

ImportedMesh import_mesh(const std::string& path, LengthUnit unit, const SolidChoice& solids) {
  try {
    return import_file(path, unit, solids);
  } catch (const ImportError& error) {
    throw ImportError("cannot import " + path + ": " + error.what());
  }
}

}  // namespace binpick::train
