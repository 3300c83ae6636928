#include "recorder/recording_shelf.hpp"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <vector>

#include "recorder/file_writing.hpp"
#include "setup_error.hpp"

namespace fs = std::filesystem;

namespace binpick::app {
namespace {

// 000012-20260102T030405Z; 0: none of ours.
std::uint32_t number_of(const std::string& name) {
  if (name.size() != 23 || name[6] != '-' || name[15] != 'T' || name[22] != 'Z') return 0;
  if (!std::all_of(name.begin(), name.begin() + 6, [](char c) { return c >= '0' && c <= '9'; }))
    return 0;
  return static_cast<std::uint32_t>(std::strtoul(name.c_str(), nullptr, 10));
}

}  // namespace

RecordingShelf::RecordingShelf(const RecordingShelfParams& params) : params_(params) {
  std::error_code error;
  fs::create_directories(params.folder, error);
  if (error) throw SetupError(params.folder + ": cannot be made: " + error.message());
  fd_ = open(params.folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd_ < 0 || access(params.folder.c_str(), W_OK) != 0) {
    const std::string reason = std::strerror(errno);
    if (fd_ >= 0) close(fd_);
    throw SetupError(params.folder + ": recordings cannot be written there: " + reason);
  }
  scan();
}

RecordingShelf::~RecordingShelf() {
  close(fd_);
}

void RecordingShelf::scan() {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(params_.folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (number_of(name) > 0) names.push_back(name);
  }
  if (error) throw SetupError(params_.folder + ": cannot be read: " + error.message());
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) {
    number_ = number_of(name);
    if (count_ == kRecordingsMax) remove_oldest();
    if (count_ == kRecordingsMax)
      throw SetupError(params_.folder + ": too many recordings that cannot be removed");
    Recording& recording = recordings_[static_cast<std::size_t>(count_++)];
    std::snprintf(recording.name, sizeof recording.name, "%s", name.c_str());
    recording.bytes =
        static_cast<std::uint64_t>(std::max<std::int64_t>(0, folder_bytes(fd_, name.c_str())));
  }
}

const char* RecordingShelf::add(std::int64_t unix_ns) {
  if (count_ == kRecordingsMax && !remove_oldest()) {
    // Forgotten, not removed: it does not count any more.
    std::move(recordings_.begin() + 1, recordings_.begin() + count_, recordings_.begin());
    --count_;
  }
  const time_t seconds = unix_ns / 1000000000;
  tm utc{};
  gmtime_r(&seconds, &utc);
  char stamp[24];
  std::strftime(stamp, sizeof stamp, "%Y%m%dT%H%M%SZ", &utc);
  number_ = number_ % 999999 + 1;
  Recording& recording = recordings_[static_cast<std::size_t>(count_++)];
  recording.bytes = 0;
  std::snprintf(recording.name, sizeof recording.name, "%06u-%s", number_, stamp);
  return recording.name;
}

void RecordingShelf::set_newest_bytes(std::int64_t bytes) {
  recordings_[static_cast<std::size_t>(count_ - 1)].bytes = static_cast<std::uint64_t>(bytes);
}

void RecordingShelf::drop_newest() {
  --count_;
}

std::uint64_t RecordingShelf::bytes() const {
  std::uint64_t sum = 0;
  for (int i = 0; i < count_; ++i) sum += recordings_[static_cast<std::size_t>(i)].bytes;
  return sum;
}

bool RecordingShelf::remove_oldest() {
  if (count_ == 0 || !remove_folder(fd_, recordings_[0].name)) return false;
  std::move(recordings_.begin() + 1, recordings_.begin() + count_, recordings_.begin());
  --count_;
  ++removed_;
  return true;
}

bool RecordingShelf::make_room(std::uint64_t bytes, bool keep_newest) {
  while (this->bytes() + bytes > params_.bytes_max) {
    if (count_ <= (keep_newest ? 1 : 0)) {
      errno = ENOSPC;
      return false;
    }
    if (!remove_oldest()) return false;
  }
  struct statvfs system {};
  if (fstatvfs(fd_, &system) != 0) return false;
  if (system.f_bavail * system.f_frsize >= params_.free_bytes_min + bytes) return true;
  errno = ENOSPC;
  return false;
}

}  // namespace binpick::app
