// binpick-cad: reads STEP and IGES with OpenCASCADE and writes triangles, in mm. A program of its
// own: binpick runs it for such files, and a station does without it and its libraries.
#include <CLI/CLI.hpp>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Standard_Failure.hxx>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "cad/body_choice.hpp"
#include "cad/cad_error.hpp"
#include "cad/solid_file.hpp"
#include "cad/tessellation.hpp"
#include "exit_code.hpp"
#include "standard_output.hpp"

namespace binpick::cad {
namespace {

struct Arguments {
  std::string file, output = "-", body;
  double deflection_mm = 0;  // 0: by the size of the part
  bool list = false;
};

template <class T>
void put(const T& value, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string ply_of(const Triangles& mesh) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment in mm\nelement vertex " +
                      std::to_string(mesh.vertices_mm.size()) +
                      "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                      std::to_string(mesh.corners.size()) +
                      "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& vertex : mesh.vertices_mm)
    for (const double x : vertex) put(static_cast<float>(x), bytes);
  for (const auto& triangle : mesh.corners) {
    bytes += '\3';
    put(triangle, bytes);
  }
  return bytes;
}

void write(const std::string& path, const std::string& bytes) {
  if (path == "-") {
    std::fwrite(bytes.data(), 1, bytes.size(), stdout);
    return app::flush_standard_output();
  }
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  file.close();
  if (!file) throw CadError(path + ": cannot be written: " + std::strerror(errno));
}

void check_input(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) throw CadError("there is no such file");
  if (!std::ifstream(path)) throw CadError(std::strerror(errno));
}

// The list of the bodies, or the triangles of the one that was chosen.
std::string answer_to(const Arguments& arguments) {
  check_input(arguments.file);
  const std::vector<Body> bodies = read_bodies(arguments.file);
  if (arguments.list) {
    std::string text;
    for (const std::string& line : list_of(bodies)) text += line + "\n";
    return text;
  }
  const TopoDS_Shape shape = choose_body(bodies, arguments.body);
  const double deflection_mm =
      arguments.deflection_mm > 0 ? arguments.deflection_mm : default_deflection_mm(shape);
  const Triangles mesh = tessellate(shape, deflection_mm);
  if (mesh.missing_faces > 0) {
    std::fprintf(stderr, "binpick-cad: warning: %d faces cannot be tessellated and are missing\n",
                 mesh.missing_faces);
  }
  if (mesh.deviation_mm > deflection_mm) {
    std::fprintf(stderr,
                 "binpick-cad: warning: triangles are up to %.3g mm from the surface, where %.3g "
                 "mm were asked for\n",
                 mesh.deviation_mm, deflection_mm);
  }
  return ply_of(mesh);
}

int report(app::ExitStatus status, const std::string& message) {
  std::fprintf(stderr, "binpick-cad: error: %s\n", message.c_str());
  return status;
}

int start(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Turns STEP and IGES files into triangles, as binpick train does with them.",
               "binpick-cad");
  app.set_version_flag("--version", "binpick-cad " BINPICK_VERSION);
  app.add_option("FILE", arguments.file, "STEP or IGES file (.step .stp .iges .igs)")->required();
  app.add_option("-o,--output", arguments.output, "PLY file to write, in mm; - is standard output")
      ->capture_default_str();
  app.add_option("--body", arguments.body,
                 "Name or number of the body, or all; needed where there are several");
  app.add_option("--deflection-mm", arguments.deflection_mm,
                 "Distance of triangles from the surface, at most [0.05, or 1/2000 of the "
                 "diameter where that is more]")
      ->check(CLI::Range(0.0001, 100.0));
  app.add_flag("--list", arguments.list, "Only list the bodies: number, name, size");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0) {
      return report(app::kUsage, std::string(e.what()) + " (see binpick-cad --help)");
    }
    app.exit(e);
    app::flush_standard_output();
    return app::kDone;
  }
  // OpenCASCADE talks on standard output, where the triangles go.
  Message::DefaultMessenger()->ChangePrinters().Clear();
  std::cout.setstate(std::ios_base::failbit);
  std::string answer;
  const std::string place = arguments.file + ": ";
  try {
    answer = answer_to(arguments);
  } catch (const CadError& e) {
    return report(app::kCannotStart, place + e.what());
  } catch (const std::bad_alloc&) {
    return report(app::kCannotStart, place + "reading it needs more memory than allowed");
  } catch (const Standard_Failure& e) {
    return report(app::kCannotStart, place + "OpenCASCADE gave up: " + e.GetMessageString());
  }
  write(arguments.output, answer);
  return app::kDone;
}

}  // namespace
}  // namespace binpick::cad

int main(int argc, char** argv) {
  using namespace binpick;
  try {
    return cad::start(argc, argv);
  } catch (const cad::CadError& e) {
    return cad::report(app::kCannotStart, e.what());
  } catch (const std::exception& e) {
    return cad::report(app::kFailure, e.what());
  }
}
