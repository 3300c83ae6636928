#include "solid_import.hpp"

#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <vector>

#include "binpick/train/errors.hpp"
#include "mesh_reader.hpp"

namespace binpick::train {
namespace {

constexpr const char* kProgram = "binpick-cad";
constexpr int kNotStarted = 127;

// What a program prints, kept in memory.
class Capture {
 public:
  Capture() : fd_(memfd_create(kProgram, MFD_CLOEXEC)) {
    if (fd_ < 0) throw ImportError("no memory for what binpick-cad prints");
  }
  ~Capture() { close(fd_); }
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;

  int fd() const { return fd_; }

  std::string text() const {
    std::string bytes(static_cast<std::size_t>(std::max<off_t>(0, lseek(fd_, 0, SEEK_END))), '\0');
    std::size_t have = 0;
    while (have < bytes.size()) {
      const ssize_t count =
          pread(fd_, bytes.data() + have, bytes.size() - have, static_cast<off_t>(have));
      if (count <= 0) throw ImportError("the answer of binpick-cad is lost");
      have += static_cast<std::size_t>(count);
    }
    return bytes;
  }

 private:
  int fd_;
};

// Where binpick-cad is beside this program; else only the PATH knows.
std::string beside_this_program() {
  std::array<char, 4096> text{};
  const ssize_t size = readlink("/proc/self/exe", text.data(), text.size());
  const std::string own(text.data(), static_cast<std::size_t>(std::max<ssize_t>(0, size)));
  return own.substr(0, own.find_last_of('/') + 1) + kProgram;
}

int status_of_program(std::vector<std::string> arguments, const Capture& out, const Capture& err) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const std::string beside = beside_this_program();
  const pid_t pid = fork();
  if (pid < 0) throw ImportError("no process for binpick-cad");
  if (pid == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    dup2(out.fd(), STDOUT_FILENO);
    dup2(err.fd(), STDERR_FILENO);
    execv(beside.c_str(), argv.data());
    execvp(kProgram, argv.data());
    _exit(kNotStarted);
  }
  int status = 0;
  while (waitpid(pid, &status, 0) < 0) {
    if (errno != EINTR) throw ImportError("binpick-cad is lost");
  }
  return status;
}

// Of the lines of a program's error output those of a kind, without "binpick-cad: kind: ".
std::string lines_of(const std::string& text, const std::string& kind) {
  const std::string prefix = std::string(kProgram) + ": " + kind + ": ";
  std::string found;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line(text.data() + begin, end - begin);
    if (line.starts_with(prefix)) {
      found += found.empty() ? "" : ". ";
      found += line.substr(prefix.size());
    }
    begin = end + 1;
  }
  return found;
}

}  // namespace

bool holds_solids(const std::string& path) {
  const std::string extension = extension_of(path);
  return extension == "step" || extension == "stp" || extension == "iges" || extension == "igs";
}

std::string triangles_of_solids(const std::string& path, const SolidChoice& choice,
                                std::string& remarks) {
  std::vector<std::string> arguments{kProgram};
  if (!choice.body.empty()) arguments.push_back("--body=" + choice.body);
  if (choice.deflection_mm > 0) {
    arguments.push_back("--deflection-mm=" + std::to_string(choice.deflection_mm));
  }
  arguments.insert(arguments.end(), {"--", path});
  const Capture out, err;
  const int status = status_of_program(std::move(arguments), out, err);
  if (WIFSIGNALED(status)) raise(WTERMSIG(status));
  if (!WIFEXITED(status) || WEXITSTATUS(status) == kNotStarted) {
    throw ImportError(
        "STEP and IGES files are read by binpick-cad, which is not installed: install the package "
        "binpick-cad, or export the part as 3MF, STL or PLY");
  }
  if (WEXITSTATUS(status) != 0) {
    const std::string fault = lines_of(err.text(), "error");
    const std::string name = path + ": ";
    throw ImportError(fault.starts_with(name) ? fault.substr(name.size()) : fault);
  }
  remarks += lines_of(err.text(), "warning");
  return out.text();
}

}  // namespace binpick::train
