// Runs a reader of foreign files in a process of its own, with limits on time and memory. Whatever
// the reader does there, here it is a mesh or an error. Thread-safe.
#pragma once

#include <functional>

#include "mesh_reader.hpp"

namespace binpick::train {

struct ChildLimits {
  double wall_s = 120;
  unsigned processor_s = 60;
  std::size_t memory_bytes = std::size_t{4} << 30;  // on top of what the process holds already
};

// Reads a file; throws ImportError with the fault alone.
using FileReader = std::function<FileContent(const std::string& path)>;

// Throws ImportError with the fault alone: the reader's own, a crash, a limit that was passed, an
// answer that makes no sense. The process is a copy of this one with a single thread: the reader
// must not wait for locks that another thread may have held, and nothing but the reader runs in it.
FileContent read_in_child(const FileReader& reader, const std::string& path,
                          const ChildLimits& limits);

}  // namespace binpick::train
