#include "log/journal_socket.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace binpick::app {

std::string JournalSocket::path_of_journal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  unsigned long long device = 0, inode = 0;
  struct stat status {};
  if (stream == nullptr || std::sscanf(stream, "%llu:%llu", &device, &inode) != 2) return "";
  // A variable that was inherited says nothing of an output that was redirected since.
  const bool same =
      fstat(STDERR_FILENO, &status) == 0 && status.st_dev == device && status.st_ino == inode;
  return same ? "/run/systemd/journal/socket" : "";
}

JournalSocket::JournalSocket(const std::string& path) : path_(path) {
  if (path.empty() || path.size() >= sizeof(sockaddr_un::sun_path)) return;
  fd_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd_ < 0) return;
  const timeval second{1, 0};
  setsockopt(fd_, SOL_SOCKET, SO_SNDTIMEO, &second, sizeof second);
}

JournalSocket::~JournalSocket() {
  if (fd_ >= 0) close(fd_);
}

bool JournalSocket::send(std::string_view fields) {
  if (fd_ < 0) return false;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path_.data(), path_.size());
  // With its address each time: the journal may be started anew.
  ssize_t sent;
  do {
    sent = sendto(fd_, fields.data(), fields.size(), MSG_NOSIGNAL,
                  reinterpret_cast<const sockaddr*>(&address), sizeof address);
  } while (sent < 0 && errno == EINTR);
  return sent == static_cast<ssize_t>(fields.size());
}

}  // namespace binpick::app
