#include "recorder/file_writing.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "recorder/whole_write.hpp"

namespace binpick::app {
namespace {

// Recordings are four folders deep; what is deeper is none of ours.
constexpr int kDepthMax = 8;

bool write_text(int fd, std::string_view text) {
  return write_whole(fd, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

// As the kernel gives them: opendir() would take memory from the heap.
struct Entry {
  std::uint64_t inode;
  std::int64_t offset;
  unsigned short length;
  unsigned char type;
  char name[1];
};

// Calls visit(folder fd, name, is a folder) for each entry until one says false.
template <class Visit>
bool for_each_entry(int folder_fd, const Visit& visit) {
  alignas(Entry) char buffer[4096];
  for (;;) {
    const long bytes = syscall(SYS_getdents64, folder_fd, buffer, sizeof buffer);
    if (bytes <= 0) return bytes == 0;
    for (long at = 0; at < bytes;) {
      const auto* entry = reinterpret_cast<const Entry*>(buffer + at);
      at += entry->length;
      const char* name = reinterpret_cast<const char*>(entry) + offsetof(Entry, name);
      if (std::strcmp(name, ".") == 0 || std::strcmp(name, "..") == 0) continue;
      struct stat status {};
      if (fstatat(folder_fd, name, &status, AT_SYMLINK_NOFOLLOW) != 0) return false;
      if (!visit(name, status)) return false;
    }
  }
}

int open_folder(int parent_fd, const char* name) {
  return openat(parent_fd, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

std::int64_t bytes_below(int parent_fd, const char* name, int depth) {
  const int fd = depth > kDepthMax ? -1 : open_folder(parent_fd, name);
  if (fd < 0) return -1;
  std::int64_t sum = 0;
  const bool read = for_each_entry(fd, [&](const char* entry, const struct stat& status) {
    sum += std::int64_t{status.st_blocks} * 512;
    if (!S_ISDIR(status.st_mode)) return true;
    const std::int64_t below = bytes_below(fd, entry, depth + 1);
    sum += below;
    return below >= 0;
  });
  close(fd);
  return read ? sum : -1;
}

bool remove_below(int parent_fd, const char* name, int depth) {
  const int fd = depth > kDepthMax ? -1 : open_folder(parent_fd, name);
  if (fd < 0) return false;
  // Names come again after others were removed, so until nothing is left.
  bool removed = true;
  for (bool any = true; any && removed;) {
    any = false;
    lseek(fd, 0, SEEK_SET);
    removed = for_each_entry(fd, [&](const char* entry, const struct stat& status) {
      any = true;
      return S_ISDIR(status.st_mode) ? remove_below(fd, entry, depth + 1)
                                     : unlinkat(fd, entry, 0) == 0;
    });
  }
  close(fd);
  return removed && unlinkat(parent_fd, name, AT_REMOVEDIR) == 0;
}

}  // namespace

NewFile::NewFile(int folder_fd, const char* name) : folder_fd_(folder_fd), name_(name) {
  const int length = std::snprintf(temporary_, sizeof temporary_, "%s.new", name);
  if (length >= static_cast<int>(sizeof temporary_)) {
    errno = ENAMETOOLONG;
    return;
  }
  fd_ = openat(folder_fd, temporary_, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0640);
}

NewFile::~NewFile() {
  if (fd_ < 0) return;
  const int error = errno;  // why the caller gave up
  close(fd_);
  if (!committed_) unlinkat(folder_fd_, temporary_, 0);
  errno = error;
}

bool NewFile::commit() {
  // On the disk first: after a power cut a name stands for a whole file.
  committed_ = fdatasync(fd_) == 0 && renameat(folder_fd_, temporary_, folder_fd_, name_) == 0;
  return committed_;
}

bool write_file(int folder_fd, const char* name, std::string_view text) {
  NewFile file(folder_fd, name);
  return file.fd() >= 0 && write_text(file.fd(), text) && file.commit();
}

bool make_folders(int folder_fd, const char* path) {
  char part[256];
  for (const char* slash = path; slash != nullptr;) {
    slash = std::strchr(slash + 1, '/');
    const auto length =
        slash != nullptr ? static_cast<std::size_t>(slash - path) : std::strlen(path);
    if (length >= sizeof part) {
      errno = ENAMETOOLONG;
      return false;
    }
    std::memcpy(part, path, length);
    part[length] = '\0';
    if (mkdirat(folder_fd, part, 0750) != 0 && errno != EEXIST) return false;
  }
  return true;
}

bool append_line(int fd, std::string_view line) {
  const off_t end = lseek(fd, 0, SEEK_END);
  if (end < 0) return false;
  if (write_text(fd, line) && fdatasync(fd) == 0) return true;
  const int error = errno;
  [[maybe_unused]] const int cut = ftruncate(fd, end);
  errno = error;
  return false;
}

std::int64_t folder_bytes(int parent_fd, const char* name) {
  return bytes_below(parent_fd, name, 0);
}

bool remove_folder(int parent_fd, const char* name) {
  return remove_below(parent_fd, name, 0);
}

}  // namespace binpick::app
