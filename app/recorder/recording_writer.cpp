#include "recorder/recording_writer.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cinttypes>
#include <cstdio>

#include "binpick/base/arena_plan.hpp"
#include "recorder/file_writing.hpp"

namespace binpick::app {
namespace {

constexpr std::size_t kCameraBytes = 512;  // of a frame in scene_camera.json, at most
constexpr std::size_t kLineBytes = 16384;

struct Buffers {
  std::span<char> cameras, line;
};

template <class Memory>
Buffers take_buffers(Memory& memory) {
  return {memory.template take<char>(kCameraBytes * RecordingWriter::kFramesMax),
          memory.template take<char>(kLineBytes)};
}

// What a file of so many bytes takes on the disk; a folder counts as one of one byte.
std::int64_t on_disk(std::size_t bytes) {
  constexpr std::size_t kBlock = 4096;
  return static_cast<std::int64_t>((bytes + kBlock - 1) / kBlock * kBlock);
}

int open_below(int parent_fd, const char* path) {
  return openat(parent_fd, path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

void close_fd(int& fd) {
  if (fd >= 0) ::close(fd);
  fd = -1;
}

void add_registers(FixedText& text, std::span<const std::uint16_t> registers) {
  const char* separator = "[";
  for (const unsigned value : registers) {
    text.print("%s%u", separator, value);
    separator = ",";
  }
  text.add(registers.empty() ? "[]" : "]");
}

// A file of the configuration, in folders of its own where its name has some.
bool write_configuration_file(int folder_fd, const RecordedFile& file) {
  char path[256];
  const int length = std::snprintf(path, sizeof path, "configuration/%s", file.name.c_str());
  if (length >= static_cast<int>(sizeof path)) {
    errno = ENAMETOOLONG;
    return false;
  }
  const std::string_view folders(path, std::string_view(path).rfind('/'));
  char folder[256];
  std::snprintf(folder, sizeof folder, "%.*s", static_cast<int>(folders.size()), folders.data());
  return make_folders(folder_fd, folder) && write_file(folder_fd, path, file.text);
}

}  // namespace

std::size_t RecordingWriter::footprint(int width_max) {
  ArenaPlan plan;
  take_buffers(plan);
  return plan.bytes + PngWriter::footprint(width_max);
}

RecordingWriter::RecordingWriter(int width_max, Arena& arena)
    : png_(width_max, arena), cameras_({}), line_({}) {
  const Buffers buffers = take_buffers(arena);
  cameras_ = FixedText(buffers.cameras);
  line_ = FixedText(buffers.line);
}

void RecordingWriter::close() {
  for (int* fd : {&lines_fd_, &gray_fd_, &depth_fd_, &scene_fd_, &folder_fd_}) close_fd(*fd);
}

bool RecordingWriter::begin(int root_fd, const char* name,
                            const RecordedConfiguration& configuration) {
  close();
  cameras_.clear();
  frame_count_ = cycle_count_ = 0;
  constexpr int kFoldersAndGrowingFiles = 8;
  bytes_ = kFoldersAndGrowingFiles * on_disk(1);
  if (!make_folders(root_fd, name)) return false;
  folder_fd_ = open_below(root_fd, name);
  if (folder_fd_ >= 0 && write_head(configuration)) return true;
  const int error = errno;
  close();
  remove_folder(root_fd, name);
  errno = error;
  return false;
}

bool RecordingWriter::write_head(const RecordedConfiguration& configuration) {
  line_.clear();
  line_.add("{\"format\": 1,\n \"program\": ");
  line_.add_json_string(configuration.program);
  line_.add(",\n \"models\": [");
  for (const RecordedModel& model : configuration.models) {
    line_.add(&model == configuration.models.data() ? "\n  " : ",\n  ");
    line_.print("{\"recipe\": %d, \"path\": ", model.recipe);
    line_.add_json_string(model.path);
    line_.print(", \"hash\": \"%016" PRIx64 "\"}", model.hash);
  }
  line_.add("]}\n");
  if (!line_.whole()) {
    errno = EOVERFLOW;
    return false;
  }
  if (!write_file(folder_fd_, "recording.json", line_.text())) return false;
  bytes_ += on_disk(line_.length());
  for (const RecordedFile& file : configuration.files) {
    if (!write_configuration_file(folder_fd_, file)) return false;
    bytes_ += on_disk(file.text.size());
  }
  if (!make_folders(folder_fd_, "test/000001")) return false;
  scene_fd_ = open_below(folder_fd_, "test/000001");
  lines_fd_ = openat(folder_fd_, "cycles.jsonl", O_WRONLY | O_CREAT | O_CLOEXEC, 0640);
  return scene_fd_ >= 0 && lines_fd_ >= 0;
}

// The folder of the kind is made with its first image.
template <class T>
bool RecordingWriter::write_image(int& folder_fd, const char* kind, const char* name,
                                  std::span<const T> pixels, int width) {
  if (folder_fd < 0 && make_folders(scene_fd_, kind)) folder_fd = open_below(scene_fd_, kind);
  if (folder_fd < 0) return false;
  NewFile file(folder_fd, name);
  if (file.fd() < 0) return false;
  const std::int64_t bytes = png_.write(file.fd(), pixels, width);
  if (bytes < 0 || !file.commit()) return false;
  bytes_ += on_disk(static_cast<std::size_t>(bytes));
  return true;
}

bool RecordingWriter::write_images(const KeptRecord& record, const char* name) {
  const int width = record.frame.camera.width;
  if (record.has_depth && !write_image(depth_fd_, "depth", name, record.frame_codes(), width))
    return false;
  return !record.has_intensity ||
         write_image(gray_fd_, "gray", name, record.frame_intensity(), width);
}

bool RecordingWriter::write_camera(const KeptRecord& record) {
  const Frame& frame = record.frame;
  const CameraIntrinsics& c = frame.camera;
  cameras_.add(frame_count_ == 0 ? "{\n" : ",\n");
  // 17 digits: doubles come back as they were.
  cameras_.print("\"%d\": {\"cam_K\": [%.17g, 0, %.17g, 0, %.17g, %.17g, 0, 0, 1]", frame_count_,
                 c.fx, c.cx, c.fy, c.cy);
  cameras_.print(", \"depth_scale\": %.17g", frame.depth_scale_mm);
  if (!frame.roi.whole_image())
    cameras_.print(", \"roi\": [%d, %d, %d, %d]", frame.roi.x, frame.roi.y, frame.roi.width,
                   frame.roi.height);
  cameras_.print(", \"capture_ns\": %" PRId64 ", \"device_ns\": %" PRId64 ", \"sequence\": %" PRIu64
                 "}",
                 frame.capture_ns, frame.device_ns, frame.sequence);
  const std::size_t entries = cameras_.length();
  cameras_.add("\n}\n");
  if (!cameras_.whole()) {
    errno = EOVERFLOW;
    return false;
  }
  const bool written = write_file(scene_fd_, "scene_camera.json", cameras_.text());
  cameras_.shorten(entries);
  return written;
}

bool RecordingWriter::write_line(const KeptRecord& record, bool with_frame) {
  line_.clear();
  line_.print("{\"cycle\":%" PRIu64 ",\"unix_ms\":%" PRId64 ",\"cause\":%d,\"cause_name\":\"%s\"",
              record.cycle, record.unix_ns / 1000000, record.cause, record.cause_name);
  line_.print(",\"record\":%" PRIu64 ",\"order\":\"%s\",\"recipe_selected\":%d", record.number,
              record.order_name, record.recipe_selected);
  line_.print(",\"fault\":%s", record.fault ? "true" : "false");
  if (with_frame) line_.print(",\"scene\":1,\"image\":%d", frame_count_);
  line_.add(",\"command\":");
  add_registers(line_,
                std::span(record.command).first(static_cast<std::size_t>(record.command_count)));
  line_.add(",\"answer\":");
  add_registers(line_,
                std::span(record.answer).first(static_cast<std::size_t>(record.answer_count)));
  line_.add(",\"times_ms\":{");
  for (int i = 0; i < record.time_count; ++i) {
    const RecordedTime& time = record.times[static_cast<std::size_t>(i)];
    line_.print("%s\"%s\":%.3f", i > 0 ? "," : "", time.name, time.ms);
  }
  line_.add("}}\n");
  if (!line_.whole()) {
    errno = EOVERFLOW;
    return false;
  }
  if (!append_line(lines_fd_, line_.text())) return false;
  bytes_ += static_cast<std::int64_t>(line_.length());
  return true;
}

bool RecordingWriter::write_frame(const KeptRecord& record) {
  const std::size_t cameras_before = cameras_.length();
  char name[16];
  std::snprintf(name, sizeof name, "%06d.png", frame_count_);
  if (write_images(record, name) && write_camera(record)) return true;
  const int error = errno;
  cameras_.shorten(cameras_before);
  for (const int folder_fd : {depth_fd_, gray_fd_})
    if (folder_fd >= 0) unlinkat(folder_fd, name, 0);
  errno = error;
  return false;
}

bool RecordingWriter::takes_frame_of(const KeptRecord& record) const {
  const bool no_frame_yet = depth_fd_ < 0 && gray_fd_ < 0;
  return !record.has_frame() || no_frame_yet ||
         (record.has_depth == (depth_fd_ >= 0) && record.has_intensity == (gray_fd_ >= 0));
}

bool RecordingWriter::write(const KeptRecord& record) {
  const bool with_frame = record.has_frame();
  if (with_frame && !write_frame(record)) return false;
  const bool written = write_line(record, with_frame);
  // A frame that lost its line stays: the data set is right without it.
  frame_count_ += with_frame;
  ++cycle_count_;
  return written;
}

}  // namespace binpick::app
