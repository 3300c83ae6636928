// STL and PLY files as programs write them, whole, odd and broken: each row is a file, and what the
// import makes of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "../temporary_folder.hpp"
#include "binpick/train/errors.hpp"
#include "binpick/train/mesh.hpp"

namespace binpick::train {
namespace {

using testing::HasSubstr;

using Corner = std::array<float, 3>;

// A wedge. Its first number is what a test makes it: the first bytes of binary data.
std::array<Corner, 4> corners(float first = 0) {
  return {{{first, 0, 0}, {35, 0, 0}, {0, 20, 0}, {0, 0, 15}}};
}
constexpr std::array<std::array<int, 3>, 4> kFaces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
constexpr int kFacets = 4;

template <class T>
std::string raw(T value, bool big_endian = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (big_endian) bytes.assign(bytes.rbegin(), bytes.rend());
  return bytes;
}

std::string number(float value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6e", static_cast<double>(value));
  return text;
}

std::string binary_stl(std::string head, std::uint32_t announced = kFacets) {
  head.resize(80, ' ');
  std::string bytes = head + raw(announced);
  for (const auto& face : kFaces) {
    bytes.append(12, '\0');
    for (const int i : face) {
      const Corner corner = corners()[static_cast<std::size_t>(i)];
      for (const float x : corner) bytes += raw(x);
    }
    bytes.append(2, '\0');
  }
  return bytes;
}

std::string text_stl() {
  std::string text = "solid wedge\n";
  for (const auto& face : kFaces) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (const int i : face) {
      text += "   vertex";
      const Corner corner = corners()[static_cast<std::size_t>(i)];
      for (const float x : corner) text += " " + number(x);
      text += "\n";
    }
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid wedge\n";
}

std::string upper_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string with_line_ends(const std::string& text, const std::string& line_end) {
  std::string out;
  for (const char c : text) out += c == '\n' ? line_end : std::string(1, c);
  return out;
}

std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment made by a test\nelement vertex 4\nproperty float x\nproperty float y\n"
         "property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string text_ply() {
  std::string data;
  for (const Corner& x : corners())
    data += number(x[0]) + " " + number(x[1]) + " " + number(x[2]) + "\n";
  for (const auto& f : kFaces)
    data += "3 " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " + std::to_string(f[2]) +
            "\n";
  return ply_header("ascii") + data;
}

std::string binary_ply_data(bool big_endian, float first = 0) {
  std::string data;
  for (const Corner& x : corners(first))
    for (const float value : x) data += raw(value, big_endian);
  for (const auto& face : kFaces) {
    data += '\3';
    for (const int i : face) data += raw(i, big_endian);
  }
  return data;
}

std::string little_ply(float first = 0) {
  return ply_header("binary_little_endian") + binary_ply_data(false, first);
}
std::string big_ply(float first = 0) {
  return ply_header("binary_big_endian") + binary_ply_data(true, first);
}

std::string share_of(const std::string& bytes, double share) {
  return bytes.substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes.size())));
}

struct Case {
  const char* what;
  const char* name;
  std::string bytes;
  // A part of the error; empty: the wedge is read, and `note` is part of a note.
  std::string fault, note = "";
};

void expect_outcomes(const std::vector<Case>& cases) {
  const TemporaryFolder folder;
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    const std::string path = folder.file(c.name);
    std::ofstream(path, std::ios::binary) << c.bytes;
    std::string fault, notes;
    ImportedMesh part;
    try {
      part = import_mesh(path, LengthUnit::kMillimetre);
    } catch (const ImportError& error) {
      fault = error.what();
    }
    for (const std::string& note : part.notes) notes += note;
    if (!c.fault.empty()) {
      EXPECT_THAT(fault, testing::AllOf(HasSubstr(path), HasSubstr(c.fault)));
      continue;
    }
    EXPECT_EQ(fault, "");
    EXPECT_THAT(notes, c.note.empty() ? testing::Matcher<std::string>(testing::IsEmpty())
                                      : testing::Matcher<std::string>(HasSubstr(c.note)));
    EXPECT_EQ(part.mesh.vertices_mm.size(), 4u);
    EXPECT_EQ(part.mesh.triangles.size(), 4u);
    const MeshBounds bounds = mesh_bounds(part.mesh);
    EXPECT_LT((bounds.max_mm - Vec3(35, 20, 15)).norm(), 1e-4);
    EXPECT_LT(bounds.min_mm.norm(), 1e-4);
  }
}

TEST(BrokenMeshes, Stl) {
  const std::string text = text_stl();
  expect_outcomes({
      {"binary", "a.stl", binary_stl("wedge"), ""},
      {"binary whose head says solid", "a.stl", binary_stl("solid wedge"), ""},
      {"one byte after the facets", "a.stl", binary_stl("w") + "x", "", "1 byte after the last"},
      {"a hundred zeros after them", "a.stl", binary_stl("w") + std::string(100, '\0'), "",
       "100 bytes after the last facet left out"},
      {"solid, and bytes after the facets", "a.stl", binary_stl("solid w") + "made by a test", "",
       "14 bytes after the last facet"},
      {"text", "a.stl", text, ""},
      {"text in upper case, also the name", "A.STL", upper_case(text), ""},
      {"text with line ends of Windows", "a.stl", with_line_ends(text, "\r\n"), ""},
      {"text after a byte order mark", "a.stl", "\xEF\xBB\xBF" + text, ""},
      {"text after an empty line", "a.stl", "\n" + text, ""},
      {"text and zeros", "a.stl", text + std::string(7, '\0'), ""},
      {"text and more of it", "a.stl", text + "; a test", "", "8 bytes after the last endsolid"},
      {"more facets announced than there are", "a.stl", binary_stl("w", 7),
       "announces 7 facets, but the file has room for 4"},
      {"the same, and solid", "a.stl", binary_stl("solid w", 7),
       "announces 7 facets, but the file has room for 4"},
      {"fewer announced than there are", "a.stl", binary_stl("w", 3),
       "announces 3 facets, but there are 4"},
      {"none announced", "a.stl", binary_stl("w", 0), "announces 0 facets, but there are 4"},
      {"a number of facets that no file has", "a.stl", binary_stl("w", 4'000'000'000),
       "announces 4000000000 facets"},
      {"binary cut short", "a.stl", share_of(binary_stl("w"), 0.7), "it was cut short"},
      {"cut within its head", "a.stl", binary_stl("w").substr(0, 60), "no STL file"},
      {"text cut short", "a.stl", share_of(text, 0.7), "it was cut short"},
      {"the second solid cut short", "a.stl", text + share_of(text, 0.7), "it was cut short"},
      {"no STL at all", "a.stl", "hello", "no STL file"},
  });
}

TEST(BrokenMeshes, PlyCutShort) {
  const std::string text = text_ply();
  std::vector<Case> cases = {
      {"text", "a.ply", text, ""},
      {"text with line ends of Windows", "a.ply", with_line_ends(text, "\r\n"), ""},
      {"little endian", "a.ply", little_ply(), ""},
      {"big endian", "A.PLY", big_ply(), ""},
      {"a header without an end", "a.ply", text.substr(0, 46), "no line end_header"},
      {"nothing but the first word", "a.ply", "ply\n", "no line end_header"},
      {"no PLY at all", "a.ply", "solid\n", "does not begin with the word ply"},
      {"an unknown type", "a.ply", "ply\nelement vertex 1\nproperty quad x\nend_header\n",
       "'quad'"},
      {"an unknown format", "a.ply", "ply\nformat middle 1.0\nend_header\n", "'middle'"},
      {"more vertices announced than there are", "a.ply",
       "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n1\n2\n",
       "it ends within vertex 3 of 4000000000"}};
  for (const double share : {0.1, 0.75, 0.9, 0.99}) {
    for (const std::string& whole : {text, little_ply(), big_ply()}) {
      cases.push_back({"cut short", "a.ply", share_of(whole, share), "it was cut short"});
    }
  }
  cases.push_back({"one byte less", "a.ply", little_ply().substr(0, little_ply().size() - 1),
                   "it ends within face 4 of 4"});
  expect_outcomes(cases);
}

// Some bytes are an end of line, a blank or an end of text elsewhere.
TEST(BrokenMeshes, PlyWhoseDataBeginWithAnyByte) {
  std::vector<Case> cases;
  for (std::uint32_t byte = 0; byte < 256; ++byte) {  // the last of the bits of about 0.5
    cases.push_back(
        {"little endian", "a.ply", little_ply(std::bit_cast<float>(0x3f000000u | byte)), ""});
  }
  for (const std::uint32_t byte : {0x00, 0x09, 0x0a, 0x0d, 0x20}) {
    const std::string header = with_line_ends(ply_header("binary_little_endian"), "\r\n");
    const float little = std::bit_cast<float>(0x3f000000u | byte);
    const float big = std::bit_cast<float>(byte << 24 | 0x1234u);  // next to nothing
    cases.push_back({"Windows", "a.ply", header + binary_ply_data(false, little), ""});
    cases.push_back({"big endian", "a.ply", big_ply(big), ""});
  }
  expect_outcomes(cases);
}

}  // namespace
}  // namespace binpick::train
