// Depth and intensity images of every kind, in one table each: what is read, as which numbers; and
// what is refused, with which words.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <opencv2/imgcodecs.hpp>

#include "inputs/input_files.hpp"

namespace binpick::drivers {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kWidth = 6, kHeight = 4;

// A slope: 640 mm at the upper left and 0.5 mm more from pixel to pixel; pixel 3 is not measured.
double distance_mm(int i) {
  return i == 3 ? 0 : 640 + 0.5 * i;
}

FrameCamera camera_of(std::optional<double> depth_scale) {
  FrameCamera camera;
  camera.intrinsics = {0, 0, 500, 500, 3, 2};
  camera.depth_scale = depth_scale;
  return camera;
}

template <class T>
std::vector<T> slope(double units_per_mm, double missing) {
  std::vector<T> values;
  for (int i = 0; i < kWidth * kHeight; ++i)
    values.push_back(static_cast<T>(i == 3 ? missing : distance_mm(i) * units_per_mm));
  return values;
}

template <class T>
void write_cv(const std::string& path, std::vector<T> values, int type) {
  ASSERT_TRUE(cv::imwrite(path, cv::Mat(kHeight, kWidth, type, values.data())));
}

// As numpy.save writes it.
template <class T>
void write_npy(const std::string& path, const std::vector<T>& values, const std::string& type,
               const std::string& shape = "(4, 6)", const std::string& fortran = "False") {
  std::string header =
      "{'descr': '" + type + "', 'fortran_order': " + fortran + ", 'shape': " + shape + ", }";
  header.resize((header.size() + 10) / 64 * 64 + 64 - 10 - 1, ' ');
  header += '\n';
  std::string bytes = std::string("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() % 256);
  bytes += static_cast<char>(header.size() / 256);
  bytes += header;
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  write_text(path, bytes);
}

// All channels hold the same.
void write_exr(const std::string& path, std::vector<float> values,
               const std::vector<std::string>& channels) {
  Imf::Header header(kWidth, kHeight);
  Imf::FrameBuffer buffer;
  for (const std::string& name : channels) {
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, values.data(), header.dataWindow()));
  }
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(kHeight);
}

struct ReadableDepth {
  const char* what;
  const char* name;
  void (*write)(const std::string& path);
  std::optional<double> camera_scale, asked_scale;  // mm per unit
  std::vector<std::string> note;                    // words of it; empty: nothing was left open
};

const ReadableDepth kReadableDepths[] = {
    {"16-bit PNG",
     "depth.png",
     [](const std::string& p) { write_cv(p, slope<std::uint16_t>(10, 0), CV_16UC1); },
     0.1,
     {},
     {}},
    {"16-bit PNG, the scale asked for",
     "depth.png",
     [](const std::string& p) { write_cv(p, slope<std::uint16_t>(2, 0), CV_16UC1); },
     0.1,
     0.5,
     {}},
    {"16-bit TIFF",
     "depth.tif",
     [](const std::string& p) { write_cv(p, slope<std::uint16_t>(2, 0), CV_16UC1); },
     0.5,
     {},
     {}},
    {"float TIFF in mm",
     "depth.tiff",
     [](const std::string& p) { write_cv(p, slope<float>(1, 0), CV_32FC1); },
     {},
     {},
     {"taken for mm"}},
    {"float TIFF in metres, NaN where nothing is",
     "depth.tiff",
     [](const std::string& p) { write_cv(p, slope<float>(1e-3, NAN), CV_32FC1); },
     {},
     {},
     {"median of 0.646", "taken for metres"}},
    {"double TIFF in metres",
     "depth.tiff",
     [](const std::string& p) { write_cv(p, slope<double>(1e-3, NAN), CV_64FC1); },
     {},
     {},
     {"taken for metres"}},
    {"float TIFF, the camera file's unit",
     "depth.tiff",
     [](const std::string& p) { write_cv(p, slope<float>(1e-3, 0), CV_32FC1); },
     1000,
     {},
     {"taken for metres"}},
    {"float TIFF in metres, with the camera file's unit of whole numbers",
     "depth.tiff",
     [](const std::string& p) { write_cv(p, slope<float>(1e-3, 0), CV_32FC1); },
     0.1,
     {},
     {"taken for metres", "depth_scale of 0.1 is left to 16-bit images"}},
    {"float TIFF in mm, with the camera file's unit of whole numbers",
     "depth.tiff",
     [](const std::string& p) { write_cv(p, slope<float>(1, 0), CV_32FC1); },
     0.1,
     {},
     {"taken for mm", "depth_scale of 0.1"}},
    {"float TIFF in the camera file's unit alone",
     "depth.tiff",
     [](const std::string& p) { write_cv(p, slope<float>(0.04, 0), CV_32FC1); },
     25,
     {},
     {"taken times the camera file's depth_scale of 25"}},
    {"float TIFF, the unit asked for",
     "depth.tiff",
     [](const std::string& p) { write_cv(p, slope<float>(1e-3, 0), CV_32FC1); },
     0.1,
     1000,
     {}},
    {"PFM in metres",
     "depth.pfm",
     [](const std::string& p) { write_cv(p, slope<float>(1e-3, INFINITY), CV_32FC1); },
     {},
     {},
     {"taken for metres"}},
    {"NumPy float32 in metres",
     "depth.npy",
     [](const std::string& p) { write_npy(p, slope<float>(1e-3, NAN), "<f4"); },
     {},
     {},
     {"taken for metres"}},
    {"NumPy float64 in mm",
     "depth.npy",
     [](const std::string& p) { write_npy(p, slope<double>(1, -1), "<f8"); },
     {},
     {},
     {"taken for mm"}},
    {"NumPy uint16",
     "depth.npy",
     [](const std::string& p) { write_npy(p, slope<std::uint16_t>(2, 0), "<u2"); },
     0.5,
     {},
     {}},
    {"NumPy with an axis of one channel",
     "depth.npy",
     [](const std::string& p) { write_npy(p, slope<float>(1, 0), "<f4", "(4, 6, 1)"); },
     {},
     {},
     {"taken for mm"}},
    {"OpenEXR, one channel, a renderer's background",
     "depth.exr",
     [](const std::string& p) { write_exr(p, slope<float>(1e-3, 1e10), {"Y"}); },
     {},
     {},
     {"taken for metres"}},
    {"OpenEXR, depth among the layers of Blender",
     "depth.exr",
     [](const std::string& p) {
       write_exr(p, slope<float>(1e-3, 1e10), {"View.Depth.Z", "View.Image.R", "View.Image.G"});
     },
     {},
     {},
     {"taken for metres"}},
};

TEST(DepthFiles, OfEveryKindAreTheSameFrame) {
  const TemporaryFolder folder;
  for (const ReadableDepth& c : kReadableDepths) {
    SCOPED_TRACE(c.what);
    const std::string path = folder.file(c.name);
    c.write(path);
    LoadedFrame frame;
    ASSERT_EQ(error_of([&] {
                frame = load_frame_files(path, "", camera_of(c.camera_scale), c.asked_scale);
              }),
              "no error");
    ASSERT_EQ(frame.camera.width, kWidth);
    ASSERT_EQ(frame.camera.height, kHeight);
    for (int i = 0; i < kWidth * kHeight; ++i)
      EXPECT_NEAR(frame.depth_mm[static_cast<std::size_t>(i)], distance_mm(i), 1e-3) << i;
    ASSERT_EQ(frame.notes.size(), c.note.empty() ? 0u : 1u);
    for (const std::string& word : c.note)
      EXPECT_THAT(frame.notes[0], AllOf(HasSubstr(path), HasSubstr(word)));
    // Only whole numbers come back bit for bit from a recording of 16 bits.
    const bool whole = std::string(c.what).find("16") != std::string::npos;
    EXPECT_EQ(frame.depth_scale_mm, whole ? c.asked_scale.value_or(c.camera_scale.value_or(0)) : 0);
  }
}

struct RefusedDepth {
  const char* what;
  const char* name;
  void (*write)(const std::string& path);
  std::vector<std::string> words;
  std::optional<double> camera_scale = {};
};

void write_words(const std::string& path, const char* text) {
  write_text(path, text);
}

const RefusedDepth kRefusedDepths[] = {
    {"16 bits without a unit",
     "depth.png",
     [](const std::string& p) { write_cv(p, slope<std::uint16_t>(10, 0), CV_16UC1); },
     {"no depth_scale", "--depth-scale"}},
    {"8 bits",
     "depth.png",
     [](const std::string& p) { write_cv(p, slope<std::uint8_t>(0.1, 0), CV_8UC1); },
     {"not a depth image", "1 of 8 found"}},
    {"floats of no unit that could be",
     "depth.tiff",
     [](const std::string& p) { write_cv(p, slope<float>(0.05, 0), CV_32FC1); },
     {"median of 32.3", "not certain", "--depth-scale 1 for mm, 1000 for metres"}},
    {"floats of tenths of mm",
     "depth.tiff",
     [](const std::string& p) { write_cv(p, slope<float>(100, 0), CV_32FC1); },
     {"not certain"}},
    {"floats of mm, or of the camera file's tenths of mm",
     "depth.tiff",
     [](const std::string& p) { write_cv(p, slope<float>(10, 0), CV_32FC1); },
     {"median of 6460", "not certain", "--depth-scale"},
     0.1},
    {"NumPy, big-endian",
     "depth.npy",
     [](const std::string& p) { write_npy(p, slope<float>(1, 0), ">f4"); },
     {"big-endian", "newbyteorder"}},
    {"NumPy, by columns",
     "depth.npy",
     [](const std::string& p) { write_npy(p, slope<float>(1, 0), "<f4", "(4, 6)", "True"); },
     {"column by column", "ascontiguousarray"}},
    {"NumPy, points",
     "depth.npy",
     [](const std::string& p) { write_npy(p, slope<float>(1, 0), "<f4", "(4, 2, 3)"); },
     {"(4, 2, 3)", "(height, width)", "points[:, :, 2]"}},
    {"NumPy, a list",
     "depth.npy",
     [](const std::string& p) { write_npy(p, slope<float>(1, 0), "<f4", "(24,)"); },
     {"(24)", "(height, width)"}},
    {"NumPy, whole numbers of 32 bits",
     "depth.npy",
     [](const std::string& p) { write_npy(p, slope<std::int32_t>(1, 0), "<i4"); },
     {"'<i4'", "float32"}},
    {"NumPy, cut short",
     "depth.npy",
     [](const std::string& p) { write_npy(p, slope<float>(1, 0), "<f4", "(8, 6)"); },
     {"cut short", "192 bytes", "96"}},
    {"NumPy, a header that is none",
     "depth.npy",
     [](const std::string& p) { write_text(p, std::string("\x93NUMPY\x01\x00\x04\x00zzzz", 14)); },
     {"header is damaged"}},
    {"OpenEXR, colour alone",
     "image.exr",
     [](const std::string& p) {
       write_exr(p, slope<float>(1, 0), {"R", "G", "B"});
     },
     {"B, G, R", "call it Z"}},
    {"OpenEXR, cut short",
     "depth.exr",
     [](const std::string& p) { write_words(p, "\x76\x2f\x31\x01\x02"); },
     {"cannot be read"}},
    {"ROS bag",
     "scene.bag",
     [](const std::string& p) { write_words(p, "#ROSBAG V2.0\n"); },
     {"is a ROS bag", "numpy.save"}},
    {"ROS 2 bag",
     "scene.db3",
     [](const std::string& p) { write_text(p, std::string("SQLite format 3\0", 16)); },
     {"ROS 2", "image_saver"}},
    {"MCAP",
     "scene.mcap",
     [](const std::string& p) { write_words(p, "\x89MCAP0\r\n"); },
     {"MCAP recording"}},
    {"HDF5",
     "scene.h5",
     [](const std::string& p) { write_words(p, "\x89HDF\r\n\x1a\n"); },
     {"HDF5 file", "h5py"}},
    {"Zivid, which is HDF5 inside",
     "scene.zdf",
     [](const std::string& p) { write_words(p, "\x89HDF\r\n\x1a\n"); },
     {"Zivid frame", "PLY"}},
    {"Photoneo",
     "scene.praw",
     [](const std::string& p) { write_words(p, "whatever"); },
     {"Photoneo frame", "PhoXi Control"}},
    {"Azure Kinect",
     "scene.mkv",
     [](const std::string& p) { write_words(p, "\x1a\x45\xdf\xa3"); },
     {"Azure Kinect", "ffmpeg"}},
    {"npz",
     "depth.npz",
     [](const std::string& p) { write_words(p, "PK\x03\x04"); },
     {"ZIP archive", "numpy.load"}},
    {"a part",
     "part.stl",
     [](const std::string& p) { write_words(p, "solid part\n"); },
     {"STL file", "binpick train"}},
    {"what git did not fetch",
     "depth.png",
     [](const std::string& p) { write_words(p, "version https://git-lfs.github.com/spec/v1\n"); },
     {"Git LFS", "git lfs pull"}},
    {"a page of an expired link",
     "depth.png",
     [](const std::string& p) { write_words(p, "<!DOCTYPE html><html>"); },
     {"web page"}},
    {"raw bytes",
     "depth.raw",
     [](const std::string& p) { write_words(p, "\x01\x02\x03"); },
     {"raw bytes", "numpy.save"}},
    {"nothing", "depth.png", [](const std::string& p) { write_words(p, ""); }, {"is empty"}},
    {"anything else",
     "depth.png",
     [](const std::string& p) { write_words(p, "hello there"); },
     {"not an image that can be decoded"}},
};

TEST(DepthFiles, RefusedOnesAreNamedForWhatTheyAre) {
  const TemporaryFolder folder;
  for (const RefusedDepth& c : kRefusedDepths) {
    SCOPED_TRACE(c.what);
    const std::string path = folder.file(c.name);
    c.write(path);
    const std::string error =
        error_of([&] { load_frame_files(path, "", camera_of(c.camera_scale)); });
    EXPECT_THAT(error, HasSubstr(path));
    for (const std::string& word : c.words) EXPECT_THAT(error, HasSubstr(word));
  }
}

TEST(DepthFiles, AFrameOfAnotherSizeThanItsCameraIsRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.file("depth.png");
  write_cv(path, slope<std::uint16_t>(10, 0), CV_16UC1);
  FrameCamera camera = camera_of(0.1);
  camera.intrinsics.width = 12;
  camera.intrinsics.height = 8;
  EXPECT_THAT(error_of([&] { load_frame_files(path, "", camera); }),
              AllOf(HasSubstr("is 6x4"), HasSubstr("says 12x8"), HasSubstr("resolution")));
}

}  // namespace
}  // namespace binpick::drivers
