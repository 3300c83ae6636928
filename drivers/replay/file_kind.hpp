// What a file is, from its first bytes, whatever its name says; from its name only where a kind has
// no mark of its own. So that a file that cannot be used is called what it is, with a way on.
#pragma once

#include <string>

namespace binpick::drivers {

enum class FileFormat {
  kUnknown,
  kImage,  // what OpenCV decodes
  kExr,
  kNpy,
  kPly,
  kPcd,
  kUnsupported,
};

struct FileKind {
  FileFormat format = FileFormat::kUnknown;
  std::string name;    // "a PNG image"; empty when unknown
  std::string advice;  // of what is not supported: what to do instead
};

// Throws DatasetError when the file cannot be read, or is empty.
FileKind kind_of_file(const std::string& path);

}  // namespace binpick::drivers
