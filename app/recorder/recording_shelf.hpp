// The folder of all recordings: their numbers and sizes, the oldest of which goes when there is no
// room. Recordings are named NUMBER-TIME, so that their order does not depend on the clock; what is
// named otherwise is not touched. Nothing from the heap after construction. Thread: the recorder's
// writer.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace binpick::app {

struct RecordingShelfParams {
  std::string folder;
  std::uint64_t bytes_max = 0;       // of all recordings
  std::uint64_t free_bytes_min = 0;  // of the file system, for the others who use it
};

class RecordingShelf {
 public:
  static constexpr int kRecordingsMax = 1024;

  // Makes the folder and counts what is in it. Throws SetupError.
  explicit RecordingShelf(const RecordingShelfParams& params);
  ~RecordingShelf();
  RecordingShelf(const RecordingShelf&) = delete;
  RecordingShelf& operator=(const RecordingShelf&) = delete;

  int fd() const { return fd_; }
  // The next recording's name; valid until the next call. It is on the shelf from now on.
  const char* add(std::int64_t unix_ns);
  // What the newest one takes now.
  void set_newest_bytes(std::int64_t bytes);
  // Removes the oldest, with `keep_newest` not the newest, until `bytes` more have room. False:
  // they have none, errno says why (ENOSPC, or what kept a recording from being removed).
  bool make_room(std::uint64_t bytes, bool keep_newest);
  // The newest was not made after all.
  void drop_newest();

  std::uint64_t bytes() const;
  int count() const { return count_; }
  std::uint64_t removed_count() const { return removed_; }

 private:
  struct Recording {
    char name[32] = "";
    std::uint64_t bytes = 0;
  };
  void scan();
  bool remove_oldest();

  RecordingShelfParams params_;
  int fd_ = -1;
  std::array<Recording, kRecordingsMax> recordings_;  // oldest first
  int count_ = 0;
  std::uint32_t number_ = 0;  // of the newest
  std::uint64_t removed_ = 0;
};

}  // namespace binpick::app
