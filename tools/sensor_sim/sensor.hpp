// The simulated sensor without its wire: registers, what writing to them does, and the frames that
// it makes of its scenes. A transport adds its bootstrap registers, asks for accesses and sends
// the frames.
// Thread-safe: one lock inside. Frames are immutable once made.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "chunk_data.hpp"
#include "false_values.hpp"
#include "pixel_encoder.hpp"
#include "register_file.hpp"
#include "sensor_xml.hpp"

namespace binpick::sim {

using SharedBytes = std::shared_ptr<const std::vector<std::uint8_t>>;

// One component of a frame.
struct FramePart {
  Component component = kRange;
  std::uint32_t component_id = 0;
  std::uint32_t pixel_format = 0;
  SharedBytes bytes;
};

// What one exposure gives: all enabled components, or one of them where the transport carries one
// image at a time.
struct SensorFrame {
  std::uint64_t id = 0;  // counts the frames since the start of acquisition, from 1
  std::uint64_t timestamp_ns = 0;
  int image_id = 0;
  int width = 0, height = 0;
  std::uint32_t offset_x = 0, offset_y = 0;  // of the region, px
  std::vector<FramePart> parts;
  std::vector<std::uint8_t> chunks;  // empty when chunk mode is off
  std::size_t byte_count() const;
};

struct SensorOptions {
  SensorName name;
  Transport transport = Transport::kGigE;
  const Personality* personality = nullptr;
  double frame_rate_hz = 10;
  std::optional<bool> chunks_active;  // else as the personality has it
  std::optional<bool> confidence;     // likewise
};

class Sensor {
 public:
  // Throws DatasetError when the first scene cannot be read.
  Sensor(const SensorOptions& options, SceneSource& scenes);

  // For the transport's own registers: call with the lock held.
  std::unique_lock<std::mutex> lock() { return std::unique_lock(mutex_); }
  RegisterFile& registers() { return registers_; }
  const std::string& xml() const { return xml_; }
  int image_count() const { return scenes_.count(); }

  // Accesses from outside. `before_store` sees a write that is allowed and may refuse it;
  // `after_store` then acts on it. Both are called with the lock held.
  AccessStatus read(std::uint64_t address, std::span<std::uint8_t> out);
  AccessStatus write(std::uint64_t address, std::span<const std::uint8_t> bytes);

  // What acquisition has to know.
  bool acquiring();
  void set_acquiring(bool acquiring);
  bool triggered_by(TriggerSource source);  // trigger mode on and this the source
  bool trigger_mode();
  double frame_rate_hz();
  std::uint32_t frames_limit();  // 0: none
  void count_missed_trigger();

  // Lies about a feature from now on; "" when done, else what is wrong. See FalseValues.
  std::string tell_falsely(const std::string& feature, const std::string& value);
  void tell_the_truth();

  // Commands that were written; called without the lock. Set before the first access.
  struct Commands {
    std::function<void()> start, stop, software_trigger, reset;
  };
  void set_commands(Commands commands) { commands_ = std::move(commands); }

  // The frames of one exposure of scene image number `index` (modulo their count): one with all
  // components, or one for each component. Ids count on from `first_id`.
  std::vector<SensorFrame> expose(std::uint64_t index, std::uint64_t first_id,
                                  std::uint64_t timestamp_ns, bool multipart);

  // Loads and encodes ahead what expose will need first.
  void warm_up();
  void update_payload_size(bool multipart);

 private:
  void add_features(const SensorOptions& options);
  AccessStatus check_value(std::uint64_t address, std::span<const std::uint8_t> bytes) const;
  AccessStatus check_region(std::uint64_t address, std::uint32_t value) const;
  std::shared_ptr<const SceneFrame> view(int index);  // the region of a scene image
  Scan3dValues scan3d_values() const;
  void store_camera(const SceneFrame& frame);
  ChunkValues chunk_values(const SceneFrame& frame) const;
  SharedBytes encoded(const std::shared_ptr<const SceneFrame>& frame, Component component,
                      const PixelEncoder& encoder);
  std::vector<Component> enabled_components() const;
  std::size_t chunk_byte_count() const;

  struct Encoded {
    int image_id;
    Component component;
    std::uint32_t format;
    SharedBytes bytes;
  };

  std::mutex mutex_;
  SceneSource& scenes_;
  const Personality& personality_;
  RegisterFile registers_;
  FalseValues false_values_;
  std::string xml_;
  Commands commands_;
  bool acquiring_ = false;
  bool multipart_ = true;
  std::vector<Encoded> encoded_;                        // bounded; oldest first
  std::vector<std::shared_ptr<const SceneFrame>> cut_;  // of the region; bounded, oldest first
};

}  // namespace binpick::sim
