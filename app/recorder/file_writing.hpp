// Files that are there whole or not at all, by names relative to an open folder; nothing from the
// heap. Functions return false or -1 with errno saying why. Thread-safe: no state.
#pragma once

#include <cstdint>
#include <string_view>

namespace binpick::app {

// A new file under a temporary name; commit() puts it on the disk and renames it. Until then it
// vanishes with this object.
class NewFile {
 public:
  // `name` is borrowed for the object's life.
  NewFile(int folder_fd, const char* name);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  int fd() const { return fd_; }  // -1: cannot be made
  bool commit();

 private:
  int folder_fd_, fd_ = -1;
  const char* name_;
  char temporary_[256];
  bool committed_ = false;
};

bool write_file(int folder_fd, const char* name, std::string_view text);
// Makes the folders on the way too; an existing one is good.
bool make_folders(int folder_fd, const char* path);
// A file of lines: the line is there whole or, after a failure, not at all.
bool append_line(int fd, std::string_view line);

// What a folder and everything in it takes on the disk; -1: cannot be read.
std::int64_t folder_bytes(int parent_fd, const char* name);
// Removes it. False when something remains.
bool remove_folder(int parent_fd, const char* name);

}  // namespace binpick::app
