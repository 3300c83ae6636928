// The journal's own protocol: a datagram a message, of lines FIELD=value, to its socket
// (systemd's "Native Journal Protocol"). So a message carries the cycle's number and its cause as
// fields that journalctl can search for. Thread: one at a time.
#pragma once

#include <string>
#include <string_view>

namespace binpick::app {

class JournalSocket {
 public:
  // Where the journal listens, when this process' error output goes to it (JOURNAL_STREAM names
  // the stream); empty: a terminal, a file, another manager.
  static std::string path_of_journal();

  // `path` empty: never sends.
  explicit JournalSocket(const std::string& path);
  ~JournalSocket();
  JournalSocket(const JournalSocket&) = delete;
  JournalSocket& operator=(const JournalSocket&) = delete;

  // False: nobody took it. Waits a second at most.
  bool send(std::string_view fields);

 private:
  std::string path_;
  int fd_ = -1;
};

}  // namespace binpick::app
