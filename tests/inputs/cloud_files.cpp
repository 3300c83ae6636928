#include "inputs/cloud_files.hpp"

#include <liblzf/lzf.h>

#include <algorithm>
#include <cstring>
#include <sstream>

#include "inputs/input_files.hpp"

namespace binpick::drivers {
namespace {

// Numbers in the encoding of a file.
class NumberWriter {
 public:
  explicit NumberWriter(CloudEncoding encoding) : encoding_(encoding) {}

  template <class T>
  void put(T number) {
    if (encoding_ == CloudEncoding::kAscii) {
      std::ostringstream text;
      text.precision(9);
      text << +number << ' ';
      bytes_ += text.str();
      return;
    }
    char raw[sizeof(T)];
    std::memcpy(raw, &number, sizeof raw);
    if (encoding_ == CloudEncoding::kBigEndian) std::reverse(raw, raw + sizeof raw);
    bytes_.append(raw, sizeof raw);
  }
  void end_row() {
    if (encoding_ == CloudEncoding::kAscii) bytes_ += '\n';
  }
  const std::string& bytes() const { return bytes_; }

 private:
  CloudEncoding encoding_;
  std::string bytes_;
};

void put_gray(NumberWriter& to, const CloudStyle& style, int gray) {
  const double value = gray * style.gray_scale;
  const auto level = static_cast<std::uint8_t>(gray);
  if (style.gray.starts_with("uchar")) to.put(static_cast<std::uint8_t>(value));
  if (style.gray.starts_with("ushort")) to.put(static_cast<std::uint16_t>(value));
  if (style.gray.starts_with("float")) to.put(static_cast<float>(value));
  if (style.gray == "rgb")
    for (int i = 0; i < 3; ++i) to.put(level);
}

float packed_gray(int gray) {
  const std::uint32_t bits = 0x010101u * static_cast<std::uint32_t>(gray);
  float number;
  std::memcpy(&number, &bits, sizeof number);
  return number;
}

}  // namespace

double CloudScene::depth_mm(int i) const {
  if (!measured(i)) return 0;
  return 700 + 1.5 * (i % camera.width) - 2 * (i / camera.width);
}

// On the ray that the lens bends to pixel i: found by undoing the distortion step by step.
std::array<float, 3> CloudScene::point(int i) const {
  if (!measured(i)) return {missing, missing, missing};
  const Vec2 seen((i % camera.width - camera.cx) / camera.fx,
                  (i / camera.width - camera.cy) / camera.fy);
  Vec2 p = seen;
  for (int step = 0; step < 100; ++step) p += seen - lens.distort(p);
  const double z = depth_mm(i) * units_per_mm;
  return {static_cast<float>(p.x() * z), static_cast<float>(p.y() * z), static_cast<float>(z)};
}

void write_ply(const std::string& path, const CloudScene& scene, const CloudStyle& style) {
  constexpr const char* kFormats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  std::string text =
      std::string("ply\nformat ") + kFormats[static_cast<int>(style.encoding)] + " 1.0\n";
  for (const std::string& line : style.header) text += line + "\n";
  text += "element vertex " + std::to_string(scene.count()) +
          "\nproperty float x\nproperty float y\nproperty float z\n";
  if (style.gray == "rgb")
    text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  else if (!style.gray.empty())
    text += "property " + style.gray + "\n";
  NumberWriter body(style.encoding);
  for (int i = 0; i < scene.count(); ++i) {
    for (const float number : scene.point(i)) body.put(number);
    put_gray(body, style, scene.gray(i));
    body.end_row();
  }
  write_text(path, text + "end_header\n" + body.bytes());
}

void write_range_grid_ply(const std::string& path, const CloudScene& scene) {
  NumberWriter vertices(CloudEncoding::kAscii), grid(CloudEncoding::kAscii);
  int measured = 0;
  for (int i = 0; i < scene.count(); ++i) {
    grid.put(static_cast<std::uint8_t>(scene.measured(i)));
    if (scene.measured(i)) {
      for (const float number : scene.point(i)) vertices.put(number);
      vertices.end_row();
      grid.put(measured++);
    }
    grid.end_row();
  }
  write_text(path, "ply\nformat ascii 1.0\nobj_info num_cols " +
                       std::to_string(scene.camera.width) + "\nobj_info num_rows " +
                       std::to_string(scene.camera.height) + "\nelement vertex " +
                       std::to_string(measured) +
                       "\nproperty float x\nproperty float y\nproperty float z\n"
                       "element range_grid " +
                       std::to_string(scene.count()) +
                       "\nproperty list uchar int vertex_indices\nend_header\n" + vertices.bytes() +
                       grid.bytes());
}

void write_pcd(const std::string& path, const CloudScene& scene, const CloudStyle& style) {
  constexpr const char* kData[] = {"ascii", "binary", "", "binary_compressed"};
  const bool packed = style.gray == "rgb", gray = !style.gray.empty();
  std::string text = "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z";
  text += packed ? " rgb" : gray ? " intensity" : "";
  text += gray ? "\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1"
               : "\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1";
  const int width = style.organized ? scene.camera.width : scene.count();
  text += "\nWIDTH " + std::to_string(width) + "\nHEIGHT " + std::to_string(scene.count() / width) +
          "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(scene.count()) + "\nDATA " +
          kData[static_cast<int>(style.encoding)] + "\n";
  // Compressed data have one field of all points after the other.
  NumberWriter rows(style.encoding), fields[4] = {rows, rows, rows, rows};
  for (int i = 0; i < scene.count(); ++i) {
    const std::array<float, 3> p = scene.point(i);
    const float level =
        packed ? packed_gray(scene.gray(i)) : static_cast<float>(scene.gray(i) * style.gray_scale);
    const float numbers[4] = {p[0], p[1], p[2], level};
    for (int k = 0; k < (gray ? 4 : 3); ++k) {
      rows.put(numbers[k]);
      fields[k].put(numbers[k]);
    }
    rows.end_row();
  }
  if (style.encoding != CloudEncoding::kCompressed) return write_text(path, text + rows.bytes());
  std::string plain, small(rows.bytes().size() + 100, '\0');
  for (const NumberWriter& field : fields) plain += field.bytes();
  const auto size = static_cast<unsigned>(plain.size());
  const unsigned sizes[2] = {
      lzf_compress(plain.data(), size, small.data(), static_cast<unsigned>(small.size())), size};
  text.append(reinterpret_cast<const char*>(sizes), sizeof sizes);
  write_text(path, text + small.substr(0, sizes[0]));
}

}  // namespace binpick::drivers
