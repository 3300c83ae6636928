#include "aravis_client.hpp"

#include <algorithm>
#include <stdexcept>

namespace binpick {
namespace {

// Throws what a call of Aravis left as its error.
class ErrorCheck {
 public:
  explicit ErrorCheck(std::string what) : what_(std::move(what)) {}
  ErrorCheck(const ErrorCheck&) = delete;
  ErrorCheck& operator=(const ErrorCheck&) = delete;
  ~ErrorCheck() { g_clear_error(&error_); }

  GError** operator&() { return &error_; }
  void check() const {
    if (error_ != nullptr) throw std::runtime_error(what_ + ": " + error_->message);
  }

 private:
  std::string what_;
  GError* error_ = nullptr;
};

}  // namespace

AravisClient::AravisClient(const std::string& name) {
  ErrorCheck error(name);
  camera_.reset(arv_camera_new(name.c_str(), &error));
  error.check();
  if (!camera_) throw std::runtime_error(name + ": no camera");
  // The packet socket is for privileged processes: tests take the way that all can go.
  if (ARV_IS_GV_DEVICE(device())) {
    arv_camera_gv_set_stream_options(camera(), ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  }
  chunks_.reset(arv_camera_create_chunk_parser(camera_.get()));
}

void AravisClient::set(const std::string& feature, const std::string& value) {
  ErrorCheck error(feature);
  arv_device_set_features_from_string(device(), (feature + "=" + value).c_str(), &error);
  error.check();
}

void AravisClient::set(const std::string& feature, std::int64_t value) {
  ErrorCheck error(feature);
  arv_camera_set_integer(camera(), feature.c_str(), value, &error);
  error.check();
}

std::string AravisClient::text(const std::string& feature) {
  ErrorCheck error(feature);
  const char* value = arv_camera_get_string(camera(), feature.c_str(), &error);
  error.check();
  return value == nullptr ? "" : value;
}

std::int64_t AravisClient::integer(const std::string& feature) {
  ErrorCheck error(feature);
  const std::int64_t value = arv_camera_get_integer(camera(), feature.c_str(), &error);
  error.check();
  return value;
}

double AravisClient::number(const std::string& feature) {
  ErrorCheck error(feature);
  const double value = arv_camera_get_float(camera(), feature.c_str(), &error);
  error.check();
  return value;
}

void AravisClient::execute(const std::string& command) {
  ErrorCheck error(command);
  arv_camera_execute_command(camera(), command.c_str(), &error);
  error.check();
}

void AravisClient::start(int buffers) {
  ErrorCheck error("stream");
  stream_.reset(arv_camera_create_stream(camera(), nullptr, nullptr, &error));
  error.check();
  const auto size = static_cast<std::size_t>(integer("PayloadSize"));
  if (ARV_IS_GV_STREAM(stream_.get())) {
    // As a host under load has to set it: room for some frames, patience for resends.
    g_object_set(stream_.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED,
                 "socket-buffer-size", static_cast<int>(std::max<std::size_t>(4 * size, 1 << 22)),
                 "packet-request-ratio", 2.0, "frame-retention", 5000000u, nullptr);
  }
  for (int i = 0; i < buffers; ++i)
    arv_stream_push_buffer(stream_.get(), arv_buffer_new(size, nullptr));
  ErrorCheck start_error("start");
  arv_camera_start_acquisition(camera(), &start_error);
  start_error.check();
}

void AravisClient::stop() {
  arv_camera_stop_acquisition(camera(), nullptr);
  stream_.reset();
}

ArvBuffer* AravisClient::pop(int timeout_ms) {
  return arv_stream_timeout_pop_buffer(stream_.get(), static_cast<guint64>(timeout_ms) * 1000);
}

std::vector<ReceivedPart> parts_of(ArvBuffer* buffer) {
  std::vector<ReceivedPart> parts;
  for (guint i = 0; i < arv_buffer_get_n_parts(buffer); ++i) {
    ReceivedPart part;
    part.component_id = arv_buffer_get_part_component_id(buffer, i);
    // Of chunk data Aravis refuses to say these.
    if (arv_buffer_get_part_data_type(buffer, i) != ARV_BUFFER_PART_DATA_TYPE_CHUNK_DATA) {
      part.pixel_format = arv_buffer_get_part_pixel_format(buffer, i);
      part.width = arv_buffer_get_part_width(buffer, i);
      part.height = arv_buffer_get_part_height(buffer, i);
    }
    std::size_t size = 0;
    const auto* data = static_cast<const std::uint8_t*>(arv_buffer_get_part_data(buffer, i, &size));
    if (data != nullptr) part.bytes.assign(data, data + size);
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace binpick
