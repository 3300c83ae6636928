#include "aravis/aravis_camera.hpp"

#include <algorithm>
#include <atomic>
#include <vector>

#include "aravis/connection.hpp"
#include "aravis/features.hpp"
#include "aravis/missing_features.hpp"
#include "aravis/received_frame.hpp"
#include "aravis/scan3d_features.hpp"
#include "aravis/sensor_setup.hpp"
#include "genicam/frame_order.hpp"
#include "genicam/hole_marks.hpp"

namespace binpick::drivers {
namespace {

// Longest sleep without a look at whether the connection is still there.
constexpr std::int64_t kWaitSlice_us = 50000;
// Points, normals, colour and confidence of each pixel of the largest frame come to 40. More is a
// wrong number, and would be allocated.
constexpr std::size_t kPayloadBytesPerPixelMax = 64;
// On the USB bus Aravis has at most so much of a stream under way. Below it, once every buffer is
// under way, its thread asks for another one without a pause and fills a core.
constexpr std::size_t kUsbBytesUnderWay = std::size_t{8} << 20;
// A bus that repeats what was damaged loses no single frame: when so many in a row are incomplete,
// the stream is halted or out of step with the sensor, and only another start ends that.
constexpr int kUsbIncompleteMax = 8;
// Of a frame's packets, how many may be asked for again, resent ones included. Where leader and
// trailer are both lost, Aravis supposes 255 packets of headers more than there are, asks for them
// too, and with its own limit, a quarter, gives up the frame before the trailer comes.
constexpr double kResendRatio = 1;
// Of frames of a few kilobytes; each buffer costs transfers of its own.
constexpr std::size_t kUsbBuffersMax = 2048;

std::int64_t steady_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

class AravisCamera final : public Camera {
 public:
  explicit AravisCamera(const CameraSpec& spec)
      : spec_(spec), camera_(connect_sensor(spec.uri)), features_(camera_.get(), spec.uri) {
    lost_signal_ = g_signal_connect(arv_camera_get_device(camera_.get()), "control-lost",
                                    G_CALLBACK(on_control_lost), this);
  }
  ~AravisCamera() override {
    AravisCamera::stop();
    g_signal_handler_disconnect(arv_camera_get_device(camera_.get()), lost_signal_);
  }

  void start(FramePool& pool) override;
  Result<FrameRef> wait_frame(TimePoint deadline) override;
  Error trigger() override;
  void stop() override;
  CameraCounters counters() const override;
  std::vector<std::string> missing_features() const override { return missing_features_; }

 private:
  static void on_control_lost(ArvDevice*, gpointer self) {
    static_cast<AravisCamera*>(self)->lost_.store(true, std::memory_order_relaxed);
  }
  void check_sizes(const SensorSetup& setup, const FramePoolParams& pool) const;
  void make_stream();
  ArvBuffer* pop(TimePoint deadline);
  ArvBuffer* newest(ArvBuffer* buffer);
  void pass_over(ArvBuffer* buffer, DropReason reason);
  Result<FrameRef> take(ArvBuffer* buffer);
  DropReason fill(ArvBuffer* buffer, FrameRef& ref);
  DropReason judge_order(ArvBuffer* buffer);
  void count(DropReason reason) {
    dropped_[static_cast<std::size_t>(reason)].fetch_add(1, std::memory_order_relaxed);
  }
  void give_back(ArvBuffer* buffer);
  int buffer_count() const;
  bool out_of_step(DropReason reason);
  void count_unfinished();
  void read_stream_counters();

  CameraSpec spec_;
  GObjectPtr<ArvCamera> camera_;
  Features features_;
  gulong lost_signal_ = 0;
  std::atomic<bool> lost_{false};
  std::vector<std::string> missing_features_;

  // Between start and stop.
  FramePool* pool_ = nullptr;
  std::size_t payload_bytes_ = 0;
  std::vector<std::uint8_t> memory_;  // outlives the stream, whose buffers lie in it
  GObjectPtr<ArvStream> stream_;
  std::unique_ptr<Scan3dChunks> chunks_;
  std::unique_ptr<PayloadConverter> converter_;
  const HoleMarks marks_{static_cast<std::uint64_t>(steady_ns())};
  ReceivedFrame received_;
  ReceivedFrame::Rules rules_;
  Scan3d scan3d_;
  FrameOrder order_;
  bool awaited_ = false;         // triggered, and nothing came yet
  int incomplete_in_a_row_ = 0;  // on the USB bus
  std::int64_t trigger_wall_ns_ = 0;

  std::array<std::atomic<std::uint64_t>, kDropReasonCount> dropped_{};
  std::atomic<std::uint64_t> frames_{0}, missed_{0}, resent_{0}, missing_{0}, underruns_{0};
};

void AravisCamera::start(FramePool& pool) {
  stop();
  lost_.store(false, std::memory_order_relaxed);
  pool_ = &pool;
  require_control(camera_.get(), spec_.uri);
  const SensorSetup setup = set_up_sensor(features_, spec_);
  missing_features_ = drivers::missing_features(features_, spec_);
  rules_.formats = features_.pixel_formats();
  rules_.mono16_is_depth = spec_.profile.mono16_is_depth;
  rules_.big_endian_chunks = arv_camera_is_gv_device(camera_.get()) != FALSE;
  chunks_ = std::make_unique<Scan3dChunks>(features_, spec_);
  scan3d_ = read_scan3d(features_, spec_, setup.with_points);
  check_sizes(setup, pool.params());
  PayloadParams params;
  params.width_max = pool.params().width_max;
  params.height_max = pool.params().height_max;
  params.sensor_width = setup.sensor_width;
  params.sensor_height = setup.sensor_height;
  params.confidence_min = spec_.profile.confidence_min;
  converter_ = std::make_unique<PayloadConverter>(params);
  payload_bytes_ = setup.payload_bytes;
  for (auto& count : dropped_) count.store(0, std::memory_order_relaxed);
  for (auto* count : {&frames_, &missed_, &resent_, &missing_, &underruns_})
    count->store(0, std::memory_order_relaxed);
  order_.clear();
  awaited_ = false;
  incomplete_in_a_row_ = 0;
  trigger_wall_ns_ = 0;
  make_stream();
  CaughtError error;
  arv_camera_start_acquisition(camera_.get(), error.out());
  if (error) {
    const std::string message = error.message();
    stop();
    features_.fail("does not start: " + message);
  }
}

// What the sensor says of its frames, before memory is taken for them.
void AravisCamera::check_sizes(const SensorSetup& setup, const FramePoolParams& pool) const {
  const auto text = [](auto width, auto height) {
    return std::to_string(width) + "x" + std::to_string(height);
  };
  const auto area = [](int width, int height) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  };
  if (setup.depth_width > pool.width_max || setup.depth_height > pool.height_max)
    throw FrameTooLargeError(spec_.uri, setup.depth_width, setup.depth_height, pool);
  if (setup.payload_bytes == 0 || setup.payload_bytes < setup.depth_bytes) {
    features_.fail("the feature PayloadSize is " + std::to_string(setup.payload_bytes) +
                   ", the depth image alone has " + std::to_string(setup.depth_bytes) + " bytes");
  }
  const std::size_t payload_max = kPayloadBytesPerPixelMax * area(pool.width_max, pool.height_max);
  if (setup.payload_bytes > payload_max) {
    features_.fail("the feature PayloadSize is " + std::to_string(setup.payload_bytes) +
                   ", at most " + std::to_string(payload_max) + " bytes were planned for");
  }
  if (area(setup.sensor_width, setup.sensor_height) > setup.payload_bytes) {
    features_.fail("the features Width and Height of the largest image are " +
                   text(setup.sensor_width, setup.sensor_height) + ", PayloadSize is " +
                   std::to_string(setup.payload_bytes));
  }
}

void AravisCamera::make_stream() {
  CaughtError error;
  stream_.reset(arv_camera_create_stream(camera_.get(), nullptr, nullptr, error.out()));
  if (!stream_) features_.fail(std::string("no stream can be made: ") + error.message());
  if (ARV_IS_GV_STREAM(stream_.get())) {
    const guint retention_us = static_cast<guint>(spec_.frame_retention_ms) * 1000u;
    g_object_set(stream_.get(), "packet-request-ratio", kResendRatio, "frame-retention",
                 retention_us, "socket-buffer",
                 spec_.socket_buffer_bytes > 0 ? ARV_GV_STREAM_SOCKET_BUFFER_FIXED
                                               : ARV_GV_STREAM_SOCKET_BUFFER_AUTO,
                 nullptr);
    if (spec_.socket_buffer_bytes > 0)
      g_object_set(stream_.get(), "socket-buffer-size", spec_.socket_buffer_bytes, nullptr);
  }
  // Where the stream is made a socket's worth of room lies between the buffers: a cache line.
  const std::size_t stride = Arena::padded(payload_bytes_);
  const int count = buffer_count();
  memory_.assign(stride * static_cast<std::size_t>(count), 0);
  for (int i = 0; i < count; ++i) {
    give_back(
        arv_buffer_new(payload_bytes_, memory_.data() + stride * static_cast<std::size_t>(i)));
  }
}

int AravisCamera::buffer_count() const {
  if (arv_camera_is_uv_device(camera_.get()) == FALSE) return spec_.buffer_count;
  // One more than can be under way, and one that is being looked at.
  const std::size_t enough = std::min(kUsbBytesUnderWay / payload_bytes_ + 2, kUsbBuffersMax);
  return std::max(spec_.buffer_count, static_cast<int>(enough));
}

// To be filled again.
void AravisCamera::give_back(ArvBuffer* buffer) {
  // The memory is ours; Aravis names it by a pointer to const.
  const void* data = arv_buffer_get_data(buffer, nullptr);
  const std::ptrdiff_t offset = static_cast<const std::uint8_t*>(data) - memory_.data();
  marks_.mark(std::span(memory_).subspan(static_cast<std::size_t>(offset), payload_bytes_));
  arv_stream_push_buffer(stream_.get(), buffer);
}

void AravisCamera::stop() {
  if (stream_) {
    // A dead sensor has stopped already, and would let this wait for seconds.
    if (!lost_.load(std::memory_order_relaxed)) arv_camera_stop_acquisition(camera_.get(), nullptr);
    read_stream_counters();
    stream_.reset();  // joins its thread and frees its buffers
    count_unfinished();
  }
  chunks_.reset();
  converter_.reset();
  memory_ = {};
  pool_ = nullptr;
}

// On the USB bus a frame that is too short never ends: what follows it is taken for its rest. When
// nothing follows, as with a trigger, no buffer comes either; it shows in the memory.
void AravisCamera::count_unfinished() {
  if (!awaited_ || arv_camera_is_uv_device(camera_.get()) == FALSE) return;
  awaited_ = false;
  const std::span<const std::uint8_t> memory(memory_);
  for (std::size_t at = 0; at < memory.size(); at += Arena::padded(payload_bytes_)) {
    const auto buffer = memory.subspan(at, payload_bytes_);
    if (marks_.any_written_over(buffer) && marks_.any_left(buffer))
      return count(DropReason::kShortPayload);
  }
}

ArvBuffer* AravisCamera::pop(TimePoint deadline) {
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::microseconds>(
        deadline - std::chrono::steady_clock::now());
    const std::int64_t wait_us = std::clamp<std::int64_t>(left.count(), 0, kWaitSlice_us);
    ArvBuffer* buffer =
        wait_us > 0 ? arv_stream_timeout_pop_buffer(stream_.get(), static_cast<guint64>(wait_us))
                    : arv_stream_try_pop_buffer(stream_.get());
    if (buffer != nullptr || wait_us < kWaitSlice_us) return buffer;
    if (lost_.load(std::memory_order_relaxed)) return nullptr;
  }
}

// Free run: what waits behind `buffer` is newer.
ArvBuffer* AravisCamera::newest(ArvBuffer* buffer) {
  while (ArvBuffer* newer = arv_stream_try_pop_buffer(stream_.get())) {
    // A newer one that failed is no reason to lose a good one.
    if (arv_buffer_get_status(newer) == ARV_BUFFER_STATUS_SUCCESS ||
        arv_buffer_get_status(buffer) != ARV_BUFFER_STATUS_SUCCESS)
      std::swap(buffer, newer);
    pass_over(newer, DropReason::kSuperseded);
  }
  return buffer;
}

// A frame that nobody will look at; `reason`: why, where it is whole.
void AravisCamera::pass_over(ArvBuffer* buffer, DropReason reason) {
  const bool whole = arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS;
  count(whole ? reason : DropReason::kIncomplete);
  order_.note_dropped();
  give_back(buffer);
}

Result<FrameRef> AravisCamera::wait_frame(TimePoint deadline) {
  if (!stream_) return Error{ErrorCode::kSensorNotStarted, 0, "sensor"};
  ArvBuffer* buffer = pop(deadline);
  if (buffer == nullptr) {
    read_stream_counters();
    if (lost_.load(std::memory_order_relaxed)) return Error{ErrorCode::kSensorLost, 0, "sensor"};
    return Error{ErrorCode::kSensorTimeout, 0, "sensor"};
  }
  awaited_ = false;
  if (spec_.trigger == TriggerSource::kFreeRun && spec_.newest_wins) buffer = newest(buffer);
  Result<FrameRef> result = take(buffer);
  give_back(buffer);
  read_stream_counters();
  return result;
}

Result<FrameRef> AravisCamera::take(ArvBuffer* buffer) {
  DropReason reason = received_.read(buffer, payload_bytes_, rules_);
  if (reason == DropReason::kNone && marks_.any_left(received_.bytes()))
    reason = DropReason::kIncomplete;
  if (reason == DropReason::kNone) {
    reason = judge_order(buffer);
  } else {
    order_.note_dropped();
  }
  FrameRef ref;
  if (reason == DropReason::kNone) {
    ref = pool_->try_take();
    reason = ref ? fill(buffer, ref) : DropReason::kPoolEmpty;
  }
  if (reason != DropReason::kNone) {
    count(reason);
    if (out_of_step(reason)) return Error{ErrorCode::kSensorLost, 0, "stream"};
    return Error{ErrorCode::kSensorFrameDropped, static_cast<long long>(reason),
                 drop_reason_name(reason)};
  }
  incomplete_in_a_row_ = 0;
  frames_.fetch_add(1, std::memory_order_relaxed);
  return ref;
}

bool AravisCamera::out_of_step(DropReason reason) {
  if (ARV_IS_GV_STREAM(stream_.get())) return false;
  incomplete_in_a_row_ = reason == DropReason::kIncomplete ? incomplete_in_a_row_ + 1 : 0;
  return incomplete_in_a_row_ >= kUsbIncompleteMax;
}

// Newer than the frame before it and than the trigger that asked for it.
DropReason AravisCamera::judge_order(ArvBuffer* buffer) {
  std::uint64_t missed = 0;
  if (!order_.advance(arv_buffer_get_frame_id(buffer), missed)) return DropReason::kStale;
  missed_.fetch_add(missed, std::memory_order_relaxed);
  const auto begun_ns = static_cast<std::int64_t>(arv_buffer_get_system_timestamp(buffer));
  if (trigger_wall_ns_ != 0 && begun_ns < trigger_wall_ns_) return DropReason::kStale;
  return DropReason::kNone;
}

DropReason AravisCamera::fill(ArvBuffer* buffer, FrameRef& ref) {
  Scan3d scan3d = scan3d_;
  if (chunks_->enabled() && !chunks_->apply(buffer, scan3d)) return DropReason::kScan3d;
  const DropReason reason = converter_->convert(received_.parts(), scan3d, ref.slot());
  if (reason != DropReason::kNone) return reason;
  Frame& frame = ref.slot().frame;
  if (spec_.intrinsics) {
    const int width = frame.camera.width, height = frame.camera.height;
    frame.camera = *spec_.intrinsics;
    frame.camera.width = width;
    frame.camera.height = height;
  }
  // Aravis notes wall time when the frame's first packet comes; here it is put on the host's
  // monotonic clock.
  const std::int64_t age_ns =
      g_get_real_time() * 1000 - static_cast<std::int64_t>(arv_buffer_get_system_timestamp(buffer));
  frame.capture_ns = steady_ns() - std::max<std::int64_t>(0, age_ns);
  frame.device_ns = static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer));
  frame.sequence = arv_buffer_get_frame_id(buffer);
  return DropReason::kNone;
}

Error AravisCamera::trigger() {
  if (!stream_) return {ErrorCode::kSensorNotStarted, 0, "sensor"};
  if (spec_.trigger != TriggerSource::kSoftware) return {ErrorCode::kSensorRefused, 0, "trigger"};
  if (lost_.load(std::memory_order_relaxed)) return {ErrorCode::kSensorLost, 0, "sensor"};
  while (ArvBuffer* old = arv_stream_try_pop_buffer(stream_.get())) {
    pass_over(old, DropReason::kStale);
  }
  awaited_ = true;
  trigger_wall_ns_ = g_get_real_time() * 1000;
  CaughtError error;
  arv_camera_software_trigger(camera_.get(), error.out());
  if (error) return {ErrorCode::kSensorRefused, 0, "TriggerSoftware"};
  return {};
}

void AravisCamera::read_stream_counters() {
  if (!ARV_IS_GV_STREAM(stream_.get())) return;
  guint64 resent = 0, missing = 0, underruns = 0;
  arv_gv_stream_get_statistics(ARV_GV_STREAM(stream_.get()), &resent, &missing);
  arv_stream_get_statistics(stream_.get(), nullptr, nullptr, &underruns);
  // Of a multipart frame Aravis counts the requests only.
  const guint64 requested = arv_stream_get_info_uint64_by_name(stream_.get(), "n_resend_requests");
  resent_.store(std::max(resent, requested), std::memory_order_relaxed);
  missing_.store(missing, std::memory_order_relaxed);
  underruns_.store(underruns, std::memory_order_relaxed);
}

CameraCounters AravisCamera::counters() const {
  CameraCounters c;
  c.frames = frames_.load(std::memory_order_relaxed);
  for (std::size_t i = 0; i < c.dropped.size(); ++i)
    c.dropped[i] = dropped_[i].load(std::memory_order_relaxed);
  c.frames_missed = missed_.load(std::memory_order_relaxed);
  c.packets_resent = resent_.load(std::memory_order_relaxed);
  c.packets_missing = missing_.load(std::memory_order_relaxed);
  c.underruns = underruns_.load(std::memory_order_relaxed);
  return c;
}

}  // namespace

std::unique_ptr<Camera> open_aravis_camera(const CameraSpec& spec) {
  return std::make_unique<AravisCamera>(spec);
}

}  // namespace binpick::drivers
