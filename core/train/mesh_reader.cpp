#include "mesh_reader.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <cctype>
#include <fstream>
#include <iterator>
#include <string_view>
#include <utility>

#include "binpick/train/errors.hpp"
#include "file_frame.hpp"
#include "ply_input.hpp"
#include "solid_import.hpp"
#include "stl_input.hpp"

namespace binpick::train {
namespace {

// Some of assimp's readers mend what is wrong in a file, say so in the log and go on.
class Complaints : public Assimp::LogStream {
 public:
  // A message comes as "Error, T0: the message itself" and a line's end.
  void write(const char* message) override {
    const std::string_view line(message);
    const std::size_t colon = line.find(": ");
    if (text.size() < 1000) text += line.substr(colon == line.npos ? 0 : colon + 2);
  }
  std::string text;
};

// assimp's own steps trust the indices, so they are looked at before the first step.
void check_indices(const aiScene& scene) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      for (unsigned i = 0; i < mesh.mFaces[f].mNumIndices; ++i) {
        if (mesh.mFaces[f].mIndices[i] < mesh.mNumVertices) continue;
        throw ImportError("a triangle refers to vertex " +
                          std::to_string(mesh.mFaces[f].mIndices[i]) + " of " +
                          std::to_string(mesh.mNumVertices));
      }
    }
  }
}

// Appends a mesh as it stands in its node. A mirroring transform turns the triangles inside out,
// which is undone.
void append(const aiMesh& mesh, const aiMatrix4x4& T_file_mesh, FileContent& content) {
  auto& vertices = content.mesh.vertices_mm;
  auto& triangles = content.mesh.triangles;
  if (vertices.size() + mesh.mNumVertices > kVerticesMax ||
      triangles.size() + mesh.mNumFaces > kTrianglesMax) {
    throw ImportError("it has more than " + std::to_string(kTrianglesMax) + " triangles");
  }
  const auto first = static_cast<std::uint32_t>(vertices.size());
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D x = T_file_mesh * mesh.mVertices[i];
    vertices.emplace_back(x.x, x.y, x.z);
  }
  const bool mirrored = aiMatrix3x3(T_file_mesh).Determinant() < 0;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) {
      ++content.skipped_count;
      continue;
    }
    triangles.push_back(
        {first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
    if (mirrored) std::swap(triangles.back()[1], triangles.back()[2]);
  }
}

void append_nodes(const aiScene& scene, FileContent& content) {
  std::vector<std::pair<const aiNode*, aiMatrix4x4>> waiting;
  if (scene.mRootNode != nullptr) waiting.emplace_back(scene.mRootNode, aiMatrix4x4());
  while (!waiting.empty()) {
    const auto [node, T_file_parent] = waiting.back();
    waiting.pop_back();
    const aiMatrix4x4 T_file_node = T_file_parent * node->mTransformation;
    for (unsigned i = 0; i < node->mNumMeshes; ++i) {
      if (node->mMeshes[i] >= scene.mNumMeshes) throw ImportError("a node refers to no mesh");
      append(*scene.mMeshes[node->mMeshes[i]], T_file_node, content);
    }
    for (unsigned i = node->mNumChildren; i-- > 0;) {
      waiting.emplace_back(node->mChildren[i], T_file_node);
    }
  }
}

void add_remark(const std::string& sentence, std::string& remarks) {
  if (sentence.empty()) return;
  remarks += (remarks.empty() ? "" : ". ") + sentence;
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(file), {});
  if (!file) throw ImportError("it cannot be read");
  return bytes;
}

// Files that assimp reads wrongly, or takes for whole when they are not, are put right in memory;
// those that it does not read at all come as triangles of somebody else's making.
const aiScene* read_scene(Assimp::Importer& importer, const std::string& path,
                          const SolidChoice& solids, std::string& remarks) {
  const std::string extension = holds_solids(path) ? "ply" : extension_of(path);
  if (extension != "ply" && extension != "stl") return importer.ReadFile(path, 0);
  std::string bytes =
      holds_solids(path) ? triangles_of_solids(path, solids, remarks) : bytes_of(path);
  if (extension == "ply") complete_ply(bytes);
  if (extension == "stl") add_remark(complete_stl(bytes), remarks);
  return importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, extension.c_str());
}

}  // namespace

std::string extension_of(const std::string& path) {
  const std::size_t dot = path.find_last_of("./");
  if (dot == std::string::npos || path[dot] != '.') return "";
  std::string extension = path.substr(dot + 1);
  std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  });
  return extension;
}

FileContent read_with_assimp(const std::string& path, const SolidChoice& solids) {
  Complaints complaints;
  Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0)
      ->attachStream(&complaints, Assimp::Logger::Err);
  Assimp::Importer importer;
  FileContent content;
  const aiScene* scene = read_scene(importer, path, solids, content.remarks);
  Assimp::DefaultLogger::get()->detachStream(&complaints, Assimp::Logger::Err);
  if (scene == nullptr) throw ImportError(importer.GetErrorString());
  if (complaints.text.find("out of range") != std::string::npos) throw ImportError(complaints.text);
  if (!complaints.text.empty()) {
    add_remark("The reader complains: " + complaints.text, content.remarks);
  }
  check_indices(*scene);
  scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (scene == nullptr) throw ImportError("its polygons cannot be split into triangles");
  // The scene is the importer's, which hands it out as a constant; nobody else looks at it.
  const FileFrame frame = apply_file_frame(path, const_cast<aiScene&>(*scene));
  content.mm_per_unit = frame.mm_per_unit;
  if (frame.turned) {
    add_remark("Its z axis is not up: the part is turned so that z is", content.remarks);
  }
  append_nodes(*scene, content);
  return content;
}

}  // namespace binpick::train
