#include "mesh_import_child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>
#include <mutex>
#include <new>
#include <optional>
#include <thread>
#include <utility>

#include "binpick/train/errors.hpp"

namespace binpick::train {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint32_t kMagic = 0x6d657368;
constexpr std::uint64_t kTextBytesMax = 4000;

// Goes through the pipe first; then the text, vertices and triangles as plain arrays.
enum Outcome : std::uint32_t { kRead, kFault, kOutOfMemory };

struct ResultHeader {
  std::uint32_t magic = kMagic;
  std::uint32_t outcome = 0;
  std::uint64_t text_bytes = 0;  // the fault; of a file that was read, the reader's remarks
  std::uint64_t vertices_count = 0;
  std::uint64_t triangles_count = 0;
  std::uint64_t skipped_count = 0;
  double mm_per_unit = 0;
};

// From here to run_child: what happens inside the reading process.
void write_all(int fd, const void* data, std::size_t bytes) {
  const char* next = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t done = write(fd, next, bytes);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) _exit(1);  // nobody listens any more
    next += done;
    bytes -= static_cast<std::size_t>(done);
  }
}

void set_limit(int resource, rlim_t value, rlim_t value_hard) {
  const rlimit limit{value, value_hard};
  setrlimit(static_cast<__rlimit_resource>(resource), &limit);
}

std::size_t address_space_bytes() {
  unsigned long pages = 0;
  if (FILE* file = std::fopen("/proc/self/statm", "re")) {
    if (std::fscanf(file, "%lu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

// The parent's signal handlers and standard streams are none of the reader's business, and a crash
// of the reader is expected: no core file, no words about it.
void confine(const ChildLimits& limits) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (int number : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGINT, SIGTERM, SIGXCPU, SIGPIPE}) {
    signal(number, SIG_DFL);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  const int null = open("/dev/null", O_RDWR | O_CLOEXEC);
  for (int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(null, stream);
  set_limit(RLIMIT_CORE, 0, 0);
  // Past the first limit comes SIGXCPU, which tells the reason; past the second one SIGKILL.
  set_limit(RLIMIT_CPU, limits.processor_s, limits.processor_s + 2);
  const std::size_t memory_bytes = address_space_bytes() + limits.memory_bytes;
  set_limit(RLIMIT_AS, memory_bytes, memory_bytes);
}

[[noreturn]] void send_fault(int fd, const char* text, bool out_of_memory) {
  ResultHeader header;
  header.outcome = out_of_memory ? kOutOfMemory : kFault;
  header.text_bytes = std::min<std::uint64_t>(std::strlen(text), kTextBytesMax);
  write_all(fd, &header, sizeof header);
  write_all(fd, text, header.text_bytes);
  _exit(0);
}

[[noreturn]] void run_child(const FileReader& reader, const std::string& path,
                            const ChildLimits& limits, int fd) {
  confine(limits);
  try {
    const FileContent content = reader(path);
    ResultHeader header;
    header.text_bytes = std::min<std::uint64_t>(content.remarks.size(), kTextBytesMax);
    header.vertices_count = content.mesh.vertices_mm.size();
    header.triangles_count = content.mesh.triangles.size();
    header.skipped_count = content.skipped_count;
    header.mm_per_unit = content.mm_per_unit;
    write_all(fd, &header, sizeof header);
    write_all(fd, content.remarks.data(), header.text_bytes);
    write_all(fd, content.mesh.vertices_mm.data(), 12 * header.vertices_count);
    write_all(fd, content.mesh.triangles.data(), 12 * header.triangles_count);
    _exit(0);
  } catch (const std::bad_alloc&) {
    send_fault(fd, "no memory", true);
  } catch (const std::exception& error) {
    // assimp catches everything itself and passes on the text only.
    send_fault(fd, error.what(), std::strstr(error.what(), "bad_alloc") != nullptr);
  } catch (...) {
    send_fault(fd, "its reader gave up", false);
  }
}
static_assert(sizeof(Eigen::Vector3f) == 12 && sizeof(std::array<std::uint32_t, 3>) == 12);

// The reading process, seen from outside. Gone with this object at the latest.
class Child {
 public:
  Child(const FileReader& reader, const std::string& path, const ChildLimits& limits)
      : limits_(limits),
        deadline_(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                     std::chrono::duration<double>(limits.wall_s))) {
    // One at a time: a second child must not inherit the writing end of this pipe, or the death of
    // this child would not close it.
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw ImportError("no pipe to a reading process");
    pid_ = fork();
    if (pid_ == 0) {
      close(ends[0]);
      run_child(reader, path, limits, ends[1]);
    }
    close(ends[1]);
    fd_ = ends[0];
    if (pid_ < 0) {
      close(fd_);
      throw ImportError("no process to read it in");
    }
  }
  ~Child() {
    close(fd_);
    reap(true);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void read_all(void* data, std::size_t bytes) {
    char* next = static_cast<char*>(data);
    while (bytes > 0) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ - Clock::now());
      if (left.count() <= 0) {
        throw ImportError("reading it took longer than " + seconds(limits_.wall_s));
      }
      pollfd waiting{fd_, POLLIN, 0};
      const int wait_ms = static_cast<int>(std::min<std::int64_t>(left.count(), 60'000));
      if (poll(&waiting, 1, wait_ms) <= 0) continue;
      const ssize_t done = read(fd_, next, bytes);
      if (done < 0 && errno == EINTR) continue;
      if (done <= 0) throw ImportError(reason_of_end());
      next += done;
      bytes -= static_cast<std::size_t>(done);
    }
  }

 private:
  static std::string seconds(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g s", value);
    return text;
  }

  // The exit status, or nothing when somebody else has collected it. A child that has closed the
  // pipe but does not end is given until the deadline.
  std::optional<int> reap(bool at_once) {
    if (pid_ <= 0) return std::nullopt;
    int status = 0;
    pid_t result = 0;
    while (!at_once && Clock::now() < deadline_ && result == 0) {
      result = waitpid(pid_, &status, WNOHANG);
      if (result == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    if (result == 0) {
      kill(pid_, SIGKILL);
      do {
        result = waitpid(pid_, &status, 0);
      } while (result < 0 && errno == EINTR);
    }
    const bool known = result == pid_;
    pid_ = -1;
    return known ? std::optional<int>(status) : std::nullopt;
  }

  // The pipe is closed, so the child has ended or is about to.
  std::string reason_of_end() {
    const std::optional<int> status = reap(false);
    if (!status || !WIFSIGNALED(*status)) return "its reader ended without a result";
    const int number = WTERMSIG(*status);
    if (number == SIGXCPU) {
      return "reading it took more than " + seconds(limits_.processor_s) + " of processor time";
    }
    if (number == SIGKILL) return "its reader was killed, perhaps for lack of memory";
    const char* name = sigdescr_np(number);
    return std::string("its reader crashed (") + (name != nullptr ? name : "unknown signal") + ")";
  }

  ChildLimits limits_;
  Clock::time_point deadline_;
  pid_t pid_ = -1;
  int fd_ = -1;
};

// Text that came from a file, without what would upset a terminal or a log.
void make_printable(std::string& text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  text.erase(text.find_last_not_of(" .") + 1);
}

}  // namespace

FileContent read_in_child(const FileReader& reader, const std::string& path,
                          const ChildLimits& limits) {
  Child child(reader, path, limits);
  ResultHeader header;
  child.read_all(&header, sizeof header);
  if (header.magic != kMagic || header.outcome > kOutOfMemory ||
      header.text_bytes > kTextBytesMax) {
    throw ImportError("its reader answered with garbage");
  }
  if (header.outcome == kOutOfMemory) {
    throw ImportError("reading it needs more than " + std::to_string(limits.memory_bytes >> 20) +
                      " MiB of memory");
  }
  FileContent content;
  content.remarks.resize(header.text_bytes);
  child.read_all(content.remarks.data(), header.text_bytes);
  make_printable(content.remarks);
  if (header.outcome == kFault) {
    throw ImportError(content.remarks.empty() ? "no reason given" : content.remarks);
  }
  if (header.vertices_count > kVerticesMax || header.triangles_count > kTrianglesMax) {
    throw ImportError("it has more than " + std::to_string(kTrianglesMax) + " triangles");
  }
  content.skipped_count = header.skipped_count;
  content.mm_per_unit = header.mm_per_unit;
  content.mesh.vertices_mm.resize(header.vertices_count);
  content.mesh.triangles.resize(header.triangles_count);
  child.read_all(content.mesh.vertices_mm.data(), 12 * header.vertices_count);
  child.read_all(content.mesh.triangles.data(), 12 * header.triangles_count);
  return content;
}

}  // namespace binpick::train
