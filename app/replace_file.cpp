#include "replace_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "setup_error.hpp"

namespace fs = std::filesystem;

namespace binpick::app {
namespace {

[[noreturn]] void fail(const std::string& path, int error) {
  throw SetupError(path + ": cannot be written: " + std::strerror(error));
}

// Where the bytes finally go: behind a symbolic link, its target is replaced and not the link.
std::string target_of(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw SetupError(path + ": cannot be written: is not a regular file");
  }
  return fs::exists(status) ? fs::canonical(path, error).string() : path;
}

// A new file beside the target that vanishes with this object, unless it was renamed.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& path, const std::string& target)
      : path_(path),
        target_(target),
        name_(target + ".new" + std::to_string(getpid())),
        descriptor_(open(name_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0) fail(path_, errno);
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) close(descriptor_);
    if (!renamed_) unlink(name_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write_all(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
      const ssize_t written = write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(path_, errno);
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
  }

  // On the disk first, renamed second: a power cut leaves one of the two files, whole.
  void rename_to_target() {
    if (fsync(descriptor_) != 0) fail(path_, errno);
    if (std::rename(name_.c_str(), target_.c_str()) != 0) fail(path_, errno);
    renamed_ = true;
  }

 private:
  std::string path_, target_, name_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

}  // namespace

void check_replaceable(const std::string& path) {
  const TemporaryFile probe(path, target_of(path));
}

void replace_file(const std::string& path, std::span<const std::uint8_t> bytes) {
  TemporaryFile file(path, target_of(path));
  file.write_all(bytes);
  file.rename_to_target();
}

}  // namespace binpick::app
