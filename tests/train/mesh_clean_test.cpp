// Meshes with one fault each: what is mended, what is reported and what is refused.
#include "mesh_clean.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "binpick/train/errors.hpp"
#include "train/tetrahedron.hpp"

namespace binpick::train {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> notes_of(Mesh mesh, Mesh* cleaned = nullptr) {
  std::vector<std::string> notes;
  mesh = clean_mesh(std::move(mesh), notes);
  if (cleaned != nullptr) *cleaned = mesh;
  return notes;
}

TEST(MeshClean, LeavesAGoodMeshAlone) {
  Mesh cleaned;
  EXPECT_THAT(notes_of(tetrahedron(), &cleaned), IsEmpty());
  EXPECT_EQ(cleaned.triangles.size(), 4u);
}

TEST(MeshClean, MergesEqualVertices) {
  Mesh soup;
  for (const auto& face : kFaces) {
    const auto first = static_cast<std::uint32_t>(soup.vertices_mm.size());
    for (const auto i : face) soup.vertices_mm.push_back(kCorners[i]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  soup.vertices_mm[0].x() = -0.0f;
  Mesh cleaned;
  EXPECT_THAT(notes_of(soup, &cleaned), IsEmpty());
  EXPECT_EQ(cleaned.vertices_mm.size(), 4u);
}

TEST(MeshClean, DropsUnusedVerticesEvenBadOnes) {
  Mesh mesh = tetrahedron();
  mesh.vertices_mm.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f);
  mesh.vertices_mm.emplace_back(1e6f, 0.0f, 0.0f);
  Mesh cleaned;
  EXPECT_THAT(notes_of(mesh, &cleaned), ElementsAre("2 vertices in no triangle left out."));
  EXPECT_EQ(cleaned.vertices_mm.size(), 4u);
}

TEST(MeshClean, DropsTrianglesWithoutArea) {
  Mesh mesh = tetrahedron();
  mesh.vertices_mm.emplace_back(15.0f, 0.0f, 0.0f);  // in the middle of an edge
  mesh.triangles.push_back({0, 4, 1});
  mesh.triangles.push_back({2, 2, 3});
  Mesh cleaned;
  EXPECT_THAT(notes_of(mesh, &cleaned), ElementsAre("2 triangles without area left out."));
  EXPECT_EQ(cleaned.triangles.size(), 4u);
  EXPECT_EQ(cleaned.vertices_mm.size(), 4u);
}

TEST(MeshClean, DropsDuplicateTrianglesWhicheverWayTheyRun) {
  Mesh mesh = tetrahedron();
  mesh.triangles.push_back({2, 1, 0});
  mesh.triangles.push_back({2, 1, 3});
  Mesh cleaned;
  EXPECT_THAT(notes_of(mesh, &cleaned), ElementsAre("2 duplicate triangles left out."));
  EXPECT_EQ(cleaned.triangles.size(), 4u);
  EXPECT_THAT(notes_of(cleaned), IsEmpty());  // those that stayed still run the same way
}

TEST(MeshClean, ReportsASurfaceThatIsNotClosed) {
  Mesh mesh = tetrahedron();
  mesh.triangles.pop_back();
  EXPECT_THAT(notes_of(mesh), ElementsAre(AllOf(HasSubstr("not closed"), HasSubstr("3 edges"))));
}

TEST(MeshClean, ReportsEdgesOfMoreThanTwoTriangles) {
  Mesh mesh = tetrahedron();
  mesh.vertices_mm.emplace_back(20.0f, 20.0f, 20.0f);
  mesh.triangles.push_back({0, 1, 4});
  EXPECT_THAT(notes_of(mesh), Contains(HasSubstr("1 edge has more than two triangles")));
}

TEST(MeshClean, ReportsMixedWinding) {
  Mesh mesh = tetrahedron();
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  EXPECT_THAT(notes_of(mesh), ElementsAre(HasSubstr("along 3 edges run in opposite senses")));
}

TEST(MeshClean, TurnsASolidThatIsInsideOut) {
  Mesh mesh = tetrahedron();
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  Mesh cleaned;
  EXPECT_THAT(notes_of(mesh, &cleaned), ElementsAre(HasSubstr("inside out")));
  EXPECT_THAT(notes_of(cleaned), IsEmpty());
}

TEST(MeshClean, AllowsAFlatSheet) {
  Mesh mesh{{{0, 0, 5}, {10, 0, 5}, {0, 10, 5}}, {{0, 1, 2}}};
  EXPECT_THAT(notes_of(mesh), ElementsAre(HasSubstr("not closed")));
}

TEST(MeshClean, RefusesWhatCannotBeMended) {
  std::vector<std::string> notes;
  EXPECT_THROW(clean_mesh({}, notes), ImportError);
  Mesh dangling = tetrahedron();
  dangling.triangles[1][2] = 4;
  EXPECT_THROW(clean_mesh(dangling, notes), ImportError);
  Mesh endless = tetrahedron();
  endless.vertices_mm[2].y() = std::numeric_limits<float>::infinity();
  EXPECT_THROW(clean_mesh(endless, notes), ImportError);
  EXPECT_THROW(clean_mesh({{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}}}, notes), ImportError);
}

}  // namespace
}  // namespace binpick::train
