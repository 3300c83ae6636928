// A host of a simulated sensor: the real Aravis, with as little around it as tests need.
#pragma once

#include <arv.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace binpick {

struct Unref {
  void operator()(void* object) const { g_object_unref(object); }
};
template <class T>
using Owned = std::unique_ptr<T, Unref>;

// An ArvBuffer's content, copied.
struct ReceivedPart {
  std::uint32_t component_id = 0, pixel_format = 0;
  int width = 0, height = 0;
  std::vector<std::uint8_t> bytes;
};

class AravisClient {
 public:
  // By address, serial or id. Throws std::runtime_error with Aravis' message.
  explicit AravisClient(const std::string& name);

  ArvCamera* camera() { return camera_.get(); }
  ArvDevice* device() { return arv_camera_get_device(camera_.get()); }
  ArvStream* stream() { return stream_.get(); }
  ArvChunkParser* chunks() { return chunks_.get(); }

  // Each throws when Aravis reports an error.
  void set(const std::string& feature, const std::string& value);
  void set(const std::string& feature, std::int64_t value);
  std::string text(const std::string& feature);
  std::int64_t integer(const std::string& feature);
  double number(const std::string& feature);
  void execute(const std::string& command);

  // Makes a stream with `buffers` buffers of the payload size and starts acquisition.
  void start(int buffers = 8);
  void stop();

  // The next buffer within the time; nullptr when none came. Give it back when done.
  ArvBuffer* pop(int timeout_ms);
  void give_back(ArvBuffer* buffer) { arv_stream_push_buffer(stream_.get(), buffer); }

 private:
  Owned<ArvCamera> camera_;
  Owned<ArvStream> stream_;
  Owned<ArvChunkParser> chunks_;
};

std::vector<ReceivedPart> parts_of(ArvBuffer* buffer);

}  // namespace binpick
