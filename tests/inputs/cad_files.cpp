#include "cad_files.hpp"

#include <gtest/gtest.h>
#include <zip.h>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

#include "../temporary_folder.hpp"

namespace binpick::train {
namespace {

constexpr std::array<std::array<int, 3>, 4> kFaces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

std::string numbers(const Points& points, const char* between) {
  std::string text;
  for (const Point& p : points)
    for (const double x : p) text += (text.empty() ? "" : between) + number(x);
  return text;
}

std::string indices(const char* between) {
  std::string text;
  for (const auto& face : kFaces)
    for (const int i : face) text += (text.empty() ? "" : between) + std::to_string(i);
  return text;
}

template <class T>
std::string raw(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

void add_to_zip(zipFile zip, const char* name, const std::string& content) {
  ASSERT_EQ(zipOpenNewFileInZip(zip, name, nullptr, nullptr, 0, nullptr, 0, nullptr, 8, 6), ZIP_OK);
  ASSERT_EQ(zipWriteInFileInZip(zip, content.data(), static_cast<unsigned>(content.size())),
            ZIP_OK);
  ASSERT_EQ(zipCloseFileInZip(zip), ZIP_OK);
}

std::string zipped(const std::vector<std::pair<const char*, std::string>>& files) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.zip");
  const zipFile zip = zipOpen64(path.c_str(), APPEND_STATUS_CREATE);
  for (const auto& [name, content] : files) add_to_zip(zip, name, content);
  zipClose(zip, nullptr);
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Chunks within chunks, each with number and length.
std::string chunk_3ds(std::uint16_t id, const std::string& content) {
  return raw(id) + raw(static_cast<std::uint32_t>(content.size() + 6)) + content;
}

}  // namespace

Point y_up(const Point& p) {
  return {p[0], p[2], -p[1]};
}

Point x_up(const Point& p) {
  return {p[2], -p[0], -p[1]};
}

Point z_up(const Point& p) {
  return p;
}

Points exported(Point (*turn)(const Point& p), double mm_per_unit) {
  Points points;
  for (const Point& p : kPart) {
    points.push_back(turn(p));
    for (double& x : points.back()) x /= mm_per_unit;
  }
  return points;
}

std::string dae(const std::string& asset, const Points& points, const std::string& transform) {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema"
    version="1.4.1"><asset>)" +
         asset + R"(</asset><library_geometries><geometry id="g"><mesh><source id="p">
    <float_array id="a" count="12">)" +
         numbers(points, " ") + R"(</float_array><technique_common>
    <accessor source="#a" count="4" stride="3"><param name="X" type="float"/>
    <param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common>
    </source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    <triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>)" +
         indices(" ") + R"(</p></triangles></mesh></geometry></library_geometries>
    <library_visual_scenes><visual_scene id="s"><node id="n">)" +
         transform + R"(<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
    <scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

std::string glb(const Points& points, const std::string& transform) {
  std::string data;
  for (const Point& p : points)
    for (const double x : p) data += raw(static_cast<float>(x));
  for (const auto& face : kFaces)
    for (const int i : face) data += raw(static_cast<std::uint16_t>(i));
  std::string json = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"mesh":0)" +
                     transform +
                     R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-1,-1,-1],
    "max":[1,1,1]},{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],
    "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
    "buffers":[{"byteLength":72}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto size = [](const std::string& s) { return raw(static_cast<std::uint32_t>(s.size())); };
  const std::string chunks =
      size(json) + "JSON" + json + size(data) + std::string("BIN\0", 4) + data;
  return "glTF" + raw(std::uint32_t{2}) + raw(static_cast<std::uint32_t>(chunks.size() + 12)) +
         chunks;
}

std::string fbx(const FbxSettings& s, const Points& points, const std::string& transform) {
  const auto property = [](const char* name, const char* types, double value) {
    return std::string("P: \"") + name + "\", " + types + ", \"\"," + number(value) + "\n";
  };
  const char *integer = "\"int\", \"Integer\"", *real = "\"double\", \"Number\"";
  std::string faces;
  for (const auto& f : kFaces) {
    faces += (faces.empty() ? "" : ",") + std::to_string(f[0]) + "," + std::to_string(f[1]) + "," +
             std::to_string(-f[2] - 1);
  }
  return "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\nFBXHeaderVersion: 1003\n"
         "FBXVersion: 7400\n}\nGlobalSettings:  {\nVersion: 1000\nProperties70:  {\n" +
         property("UpAxis", integer, s.up) + property("UpAxisSign", integer, s.up_sign) +
         property("FrontAxis", integer, s.front) +
         property("FrontAxisSign", integer, s.front_sign) +
         property("CoordAxis", integer, s.coord) +
         property("CoordAxisSign", integer, s.coord_sign) +
         property("UnitScaleFactor", real, s.centimetres) +
         "}\n}\nObjects:  {\nGeometry: 1000, \"Geometry::part\", \"Mesh\" {\nVertices: *12 {\na: " +
         numbers(points, ",") + "\n}\nPolygonVertexIndex: *12 {\na: " + faces +
         "\n}\nGeometryVersion: 124\n}\nModel: 2000, \"Model::part\", \"Mesh\" {\nVersion: 232\n"
         "Properties70:  {\n" +
         transform + "}\n}\n}\nConnections:  {\nC: \"OO\",2000,0\nC: \"OO\",1000,2000\n}\n";
}

std::string amf(const std::string& unit, const Points& points) {
  std::string xml = "<?xml version=\"1.0\"?><amf" + unit + "><object id=\"0\"><mesh><vertices>";
  for (const Point& p : points) {
    xml += "<vertex><coordinates><x>" + number(p[0]) + "</x><y>" + number(p[1]) + "</y><z>" +
           number(p[2]) + "</z></coordinates></vertex>";
  }
  xml += "</vertices><volume>";
  for (const auto& f : kFaces) {
    xml += "<triangle><v1>" + std::to_string(f[0]) + "</v1><v2>" + std::to_string(f[1]) +
           "</v2><v3>" + std::to_string(f[2]) + "</v3></triangle>";
  }
  return xml + "</volume></mesh></object></amf>";
}

std::string model_of_3mf(const std::string& unit, const Points& points, const std::string& item) {
  std::string xml = "<?xml version=\"1.0\"?><!-- <model unit=\"micron\"> --><model" + unit +
                    " xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">"
                    "<resources><object id=\"1\" type=\"model\"><mesh><vertices>";
  for (const Point& p : points) {
    xml += "<vertex x=\"" + number(p[0]) + "\" y=\"" + number(p[1]) + "\" z=\"" + number(p[2]) +
           "\"/>";
  }
  xml += "</vertices><triangles>";
  for (const auto& f : kFaces) {
    xml += "<triangle v1=\"" + std::to_string(f[0]) + "\" v2=\"" + std::to_string(f[1]) +
           "\" v3=\"" + std::to_string(f[2]) + "\"/>";
  }
  return xml + "</triangles></mesh></object></resources><build><item objectid=\"1\"" + item +
         "/></build></model>";
}

// A 3MF is a zip archive whose relations name the model.
std::string zipped_3mf(const std::string& model) {
  return zipped({{"_rels/.rels",
                  R"(<?xml version="1.0"?><Relationships
    xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship
    Target="/3D/3dmodel.model" Id="rel0"
    Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>)"},
                 {"3D/3dmodel.model", model}});
}

std::string zae(const std::string& collada) {
  return zipped({{"manifest.xml", "<?xml version=\"1.0\"?><dae_root>part.dae</dae_root>"},
                 {"part.dae", collada}});
}

std::string file_3ds(const Points& points) {
  std::string vertices = raw(std::uint16_t{4}), faces = raw(std::uint16_t{4});
  for (const Point& p : points)
    for (const double x : p) vertices += raw(static_cast<float>(x));
  for (const auto& face : kFaces) {
    for (const int i : face) faces += raw(static_cast<std::uint16_t>(i));
    faces += raw(std::uint16_t{7});
  }
  const std::string mesh =
      chunk_3ds(0x4100, chunk_3ds(0x4110, vertices) + chunk_3ds(0x4120, faces));
  return chunk_3ds(0x4D4D, chunk_3ds(0x3D3D, chunk_3ds(0x4000, std::string("part\0", 5) + mesh)));
}

std::string dxf(const Points& points) {
  std::string text = "0\nSECTION\n2\nENTITIES\n";
  for (const auto& f : kFaces) {
    text += "0\n3DFACE\n8\n0\n";
    const int corners[] = {f[0], f[1], f[2], f[2]};
    for (int i = 0; i < 4; ++i) {
      const Point& p = points[static_cast<std::size_t>(corners[i])];
      for (int axis = 0; axis < 3; ++axis) {
        text += std::to_string(10 * (axis + 1) + i) + "\n" +
                number(p[static_cast<std::size_t>(axis)]) + "\n";
      }
    }
  }
  return text + "0\nENDSEC\n0\nEOF\n";
}

std::string obj(const Points& points) {
  std::string text;
  for (const Point& p : points)
    text += "v " + number(p[0]) + " " + number(p[1]) + " " + number(p[2]) + "\n";
  for (const auto& f : kFaces) {
    text += "f " + std::to_string(f[0] + 1) + " " + std::to_string(f[1] + 1) + " " +
            std::to_string(f[2] + 1) + "\n";
  }
  return text;
}

}  // namespace binpick::train
