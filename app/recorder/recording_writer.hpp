// One recording on the disk: a data set in the BOP layout and a line of JSON an order.
//
//   RECORDING/recording.json            format, program, models with their hashes
//   RECORDING/configuration/...         the configuration's files
//   RECORDING/test/000001/depth, gray, scene_camera.json    the folders of what its frames have
//   RECORDING/cycles.jsonl              a line is written when its frame is there
//
// Every file is there whole or not at all; a line without its end is one that was cut off by a
// crash. Nothing from the heap. Thread: the recorder's writer.
#pragma once

#include <span>
#include <string_view>

#include "fixed_text.hpp"
#include "recorder/cycle_record.hpp"
#include "recorder/png_writer.hpp"
#include "recorder/record_ring.hpp"

namespace binpick::app {

class RecordingWriter {
 public:
  static constexpr int kFramesMax = 256;  // then another recording is begun

  static std::size_t footprint(int width_max);
  RecordingWriter(int width_max, Arena& arena);
  ~RecordingWriter() { close(); }
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  // Makes the folder `name` below `root_fd` and ends the recording before. False: errno says why;
  // what was made so far is removed.
  bool begin(int root_fd, const char* name, const RecordedConfiguration& configuration);
  bool is_open() const { return folder_fd_ >= 0; }
  bool is_full() const { return cycle_count_ >= kFramesMax; }
  // A data set says by its folders what each of its frames has: another kind of frame begins
  // another recording.
  bool takes_frame_of(const KeptRecord& record) const;
  void close();

  // False: errno says why; what is on the disk is a recording without this record.
  bool write(const KeptRecord& record);
  std::int64_t bytes() const { return bytes_; }  // written to this recording

 private:
  bool write_head(const RecordedConfiguration& configuration);
  bool write_frame(const KeptRecord& record);
  bool write_images(const KeptRecord& record, const char* name);
  bool write_camera(const KeptRecord& record);
  bool write_line(const KeptRecord& record, bool with_frame);
  template <class T>
  bool write_image(int& folder_fd, const char* kind, const char* name, std::span<const T> pixels,
                   int width);

  PngWriter png_;
  FixedText cameras_, line_;
  int folder_fd_ = -1, scene_fd_ = -1, depth_fd_ = -1, gray_fd_ = -1, lines_fd_ = -1;
  int frame_count_ = 0, cycle_count_ = 0;
  std::int64_t bytes_ = 0;
};

}  // namespace binpick::app
