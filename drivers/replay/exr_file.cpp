#include "replay/exr_file.hpp"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>

#include <algorithm>
#include <cctype>
#include <exception>

#include "binpick/drivers/loaded_frame.hpp"

namespace binpick::drivers {
namespace {

constexpr int kExrSideMax = 32768;

std::string last_part(std::string name) {
  name.erase(0, name.rfind('.') + 1);  // npos + 1 is 0
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

std::string depth_channel(const std::string& path, const Imf::ChannelList& channels) {
  std::vector<std::string> names;
  std::string list;
  for (auto it = channels.begin(); it != channels.end(); ++it) {
    names.emplace_back(it.name());
    list += (list.empty() ? "" : ", ") + names.back();
  }
  if (names.size() == 1) return names.front();
  for (const char* wanted : {"z", "depth", "v", "y"}) {
    const auto is_it = [&](const std::string& name) { return last_part(name) == wanted; };
    if (std::count_if(names.begin(), names.end(), is_it) == 1)
      return *std::find_if(names.begin(), names.end(), is_it);
  }
  throw DatasetError(path + ": none of its channels (" + list +
                     ") is the depth: save a single one, or call it Z");
}

}  // namespace

RawDepth read_exr_depth(const std::string& path) {
  try {
    Imf::InputFile file(path.c_str());
    const auto window = file.header().dataWindow();
    const long width = static_cast<long>(window.max.x) - window.min.x + 1;
    const long height = static_cast<long>(window.max.y) - window.min.y + 1;
    if (width <= 0 || height <= 0 || width > kExrSideMax || height > kExrSideMax)
      throw DatasetError(path + ": has an image of no usable size");
    RawDepth depth{static_cast<int>(width), static_cast<int>(height), {}, {}};
    depth.values.resize(static_cast<std::size_t>(width * height));
    // The slice's address is that of pixel (0, 0), which the data window need not hold.
    Imf::FrameBuffer buffer;
    buffer.insert(depth_channel(path, file.header().channels()),
                  Imf::Slice::Make(Imf::FLOAT, depth.values.data(), window));
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    return depth;
  } catch (const DatasetError&) {
    throw;
  } catch (const std::exception& e) {
    throw DatasetError(path + ": is an OpenEXR image that cannot be read (" + e.what() + ")");
  }
}

}  // namespace binpick::drivers
