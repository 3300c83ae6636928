#include "replay/file_kind.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "binpick/drivers/loaded_frame.hpp"

namespace binpick::drivers {
namespace {

using namespace std::string_view_literals;
using enum FileFormat;

struct Mark {
  std::string_view bytes;  // at the beginning
  FileFormat format;
  const char* name;
  const char* advice = "";
};

constexpr const char* kSaveNpy =
    "save the depth of one frame from Python: numpy.save('depth.npy', depth)";
constexpr const char* kBagAdvice =
    "take one frame's depth out of it as 16-bit PNG or .npy: with ROS 'rosrun image_view "
    "image_saver', with RealSense numpy.save('depth.npy', "
    "numpy.asanyarray(depth_frame.get_data()))";

constexpr Mark kMarks[] = {
    {"\x89PNG\r\n\x1a\n"sv, kImage, "a PNG image"},
    {"\xff\xd8\xff"sv, kImage, "a JPEG image"},
    {"II*\0"sv, kImage, "a TIFF image"},
    {"MM\0*"sv, kImage, "a TIFF image"},
    {"II+\0"sv, kImage, "a BigTIFF image"},
    {"MM\0+"sv, kImage, "a BigTIFF image"},
    {"BM"sv, kImage, "a BMP image"},
    {"P2\n"sv, kImage, "a PGM image"},
    {"P5\n"sv, kImage, "a PGM image"},
    {"P6\n"sv, kImage, "a PPM image"},
    {"Pf\n"sv, kImage, "a PFM image"},
    {"\x76\x2f\x31\x01"sv, kExr, "an OpenEXR image"},
    {"\x93NUMPY"sv, kNpy, "a NumPy array"},
    {"ply\n"sv, kPly, "a PLY file"},
    {"ply\r"sv, kPly, "a PLY file"},
    {"# .PCD"sv, kPcd, "a PCD point cloud"},
    {"#.PCD"sv, kPcd, "a PCD point cloud"},
    {"VERSION ."sv, kPcd, "a PCD point cloud"},
    {"VERSION 0"sv, kPcd, "a PCD point cloud"},
    {"#ROSBAG"sv, kUnsupported, "a ROS bag, as ROS 1 and RealSense record it", kBagAdvice},
    {"SQLite format 3\0"sv, kUnsupported, "an SQLite file, as ROS 2 records bags (.db3)",
     kBagAdvice},
    {"\x89MCAP0\r\n"sv, kUnsupported, "an MCAP recording, as ROS 2 records bags", kBagAdvice},
    {"\x89HDF\r\n\x1a\n"sv, kUnsupported, "an HDF5 file",
     "with Python: numpy.save('depth.npy', h5py.File(FILE)[NAME][...]); h5ls lists the names"},
    {"MATLAB"sv, kUnsupported, "a MATLAB file",
     "with Python: numpy.save('depth.npy', scipy.io.loadmat(FILE)[NAME])"},
    {"PK\x03\x04"sv, kUnsupported, "a ZIP archive, such as .npz",
     "unpack it; .npz with Python: numpy.save('depth.npy', numpy.load(FILE)[NAME])"},
    {"\x1f\x8b"sv, kUnsupported, "a gzip archive", "unpack it with gunzip"},
    {"\x28\xb5\x2f\xfd"sv, kUnsupported, "a Zstandard archive", "unpack it with unzstd"},
    {"7z\xbc\xaf\x27\x1c"sv, kUnsupported, "a 7-Zip archive", "unpack it with 7z x"},
    {"\x1a\x45\xdf\xa3"sv, kUnsupported, "a Matroska recording, as Azure Kinect makes it (.mkv)",
     "take the depth track out of it: ffmpeg -i FILE -map 0:1 -vsync 0 depth%04d.png"},
    {"NI10"sv, kUnsupported, "an OpenNI recording (.oni)", kSaveNpy},
    {"ASTM-E57"sv, kUnsupported, "an E57 point cloud",
     "export an organized cloud (PLY or PCD), or a depth image"},
    {"LASF"sv, kUnsupported, "a LAS point cloud",
     "it has no grid: export a depth image, or an organized PLY or PCD"},
    {"glTF"sv, kUnsupported, "a glTF file", "it has no depth: give a depth image"},
    {"solid "sv, kUnsupported, "an STL file", "it has no depth: a part goes to binpick train"},
    {"\x80\x04"sv, kUnsupported, "a Python pickle", kSaveNpy},
    {"\x80\x03"sv, kUnsupported, "a Python pickle", kSaveNpy},
    {"version https://git-lfs"sv, kUnsupported, "a Git LFS pointer, not the file itself",
     "fetch the file: git lfs pull"},
    {"<!DOCTYPE html"sv, kUnsupported, "a web page", "download the file itself"},
    {"<html"sv, kUnsupported, "a web page", "download the file itself"},
};

struct Ending {
  std::string_view ending;
  const char* name;
  const char* advice;
};

// Kinds of which the first bytes tell less than the name.
constexpr Ending kEndings[] = {
    {".zdf", "a Zivid frame (.zdf)",
     "in Zivid Studio: File, Export, PLY with 'ordered points'; or with its Python samples: "
     "convert_zdf.py --ply"},
    {".praw", "a Photoneo frame (.praw)", "in PhoXi Control: save it as PLY"},
    {".prawf", "a Photoneo frame (.prawf)", "in PhoXi Control: save it as PLY"},
    {".hobj", "a HALCON object (.hobj)",
     "in HALCON: write_image(Image, 'tiff', 0, 'depth.tif'), of the Z image"},
    {".om3", "a HALCON 3D object model (.om3)",
     "in HALCON: object_model_3d_to_xyz, then write_image of Z as 'tiff'"},
    {".bag", "a recording (.bag)", kBagAdvice},
    {".xyz", "a text of points",
     "it has no grid: export a depth image, or an organized PLY or PCD"},
    {".csv", "a table", "with Python: numpy.save('depth.npy', numpy.loadtxt(FILE, delimiter=','))"},
    {".raw", "raw bytes, which do not tell their size", kSaveNpy},
    {".bin", "raw bytes, which do not tell their size", kSaveNpy},
};

}  // namespace

FileKind kind_of_file(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw DatasetError(path + ": is a folder, not a file");
  if (!std::filesystem::exists(path, error)) throw DatasetError(path + ": there is no such file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw DatasetError(path + ": cannot be opened");
  char buffer[32] = {};
  file.read(buffer, sizeof buffer);
  const std::string_view begin(buffer, static_cast<std::size_t>(file.gcount()));
  if (begin.empty()) throw DatasetError(path + ": is empty");

  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const Mark& mark : kMarks) {
    // What is inside of HDF5 its maker's name tells.
    const bool made_of_hdf5 = ending == ".zdf" || ending == ".praw" || ending == ".prawf";
    if (begin.starts_with(mark.bytes) && !made_of_hdf5)
      return {mark.format, mark.name, mark.advice};
  }
  const auto named = std::find_if(std::begin(kEndings), std::end(kEndings),
                                  [&](const Ending& e) { return e.ending == ending; });
  if (named != std::end(kEndings)) return {kUnsupported, named->name, named->advice};
  return {};
}

}  // namespace binpick::drivers
