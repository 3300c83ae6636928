#include "mesh_reader.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <string_view>
#include <utility>

#include "binpick/train/errors.hpp"

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

}  // namespace

FileContent read_with_assimp(const std::string& path) {
  Complaints complaints;
  Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0)
      ->attachStream(&complaints, Assimp::Logger::Err);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path, 0);
  Assimp::DefaultLogger::get()->detachStream(&complaints, Assimp::Logger::Err);
  if (scene == nullptr) throw ImportError(importer.GetErrorString());
  if (complaints.text.find("out of range") != std::string::npos) throw ImportError(complaints.text);
  check_indices(*scene);
  scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (scene == nullptr) throw ImportError("its polygons cannot be split into triangles");
  FileContent content;
  content.complaints = complaints.text;
  append_nodes(*scene, content);
  return content;
}

}  // namespace binpick::train
