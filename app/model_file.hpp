// A model file in memory, where ObjectModel reads it in place. Thread-safe: immutable.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "binpick/model/object_model.hpp"

namespace binpick::app {

class ModelFile {
 public:
  // Throws SetupError with one sentence that names the file: unreadable, foreign, damaged.
  explicit ModelFile(const std::string& path);

  const ObjectModel& model() const { return model_; }
  const std::string& path() const { return path_; }
  // The file's name without folders and extension: what people call the part.
  const std::string& name() const { return name_; }
  std::size_t size_bytes() const { return bytes_.size; }
  // FNV-1a of 64-bit words and the last bytes: tells files apart, for recordings.
  std::uint64_t checksum() const;

 private:
  struct FreeAligned {
    void operator()(std::uint8_t* p) const;
  };
  struct Bytes {
    std::unique_ptr<std::uint8_t[], FreeAligned> data;
    std::size_t size = 0;
  };
  static Bytes read(const std::string& path);
  static ObjectModel parse(const std::string& path, const Bytes& bytes);

  std::string path_, name_;
  Bytes bytes_;
  ObjectModel model_;
};

}  // namespace binpick::app
