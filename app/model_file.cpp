#include "model_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <span>

#include "error_text.hpp"
#include "setup_error.hpp"

namespace binpick::app {
namespace {

constexpr std::align_val_t kAlignment{64};  // ObjectModel reads tables of wide types in place
constexpr std::uintmax_t kModelBytesMax = 1u << 30;

}  // namespace

void ModelFile::FreeAligned::operator()(std::uint8_t* p) const {
  ::operator delete[](p, kAlignment);
}

ModelFile::Bytes ModelFile::read(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw SetupError(path + ": there is no such model file");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw SetupError(path + ": cannot be read: " + error.message());
  if (size > kModelBytesMax) throw SetupError(path + ": is too large for a model file");
  Bytes bytes;
  bytes.size = static_cast<std::size_t>(size);
  bytes.data.reset(new (kAlignment) std::uint8_t[bytes.size]);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(bytes.data.get()), static_cast<std::streamsize>(bytes.size));
  if (!file) throw SetupError(path + ": cannot be read: " + std::strerror(errno));
  return bytes;
}

ObjectModel ModelFile::parse(const std::string& path, const Bytes& bytes) {
  const std::span<const std::uint8_t> span(bytes.data.get(), bytes.size);
  const Result<ObjectModel> model = ObjectModel::parse(span);
  if (model.ok()) return model.value();
  throw SetupError(path + ": " + error_text(model.error()));
}

std::uint64_t ModelFile::checksum() const {
  constexpr std::uint64_t kPrime = 0x100000001B3;
  std::uint64_t hash = 0xCBF29CE484222325;
  std::size_t i = 0;
  for (; i + sizeof hash <= bytes_.size; i += sizeof hash) {
    std::uint64_t word;
    std::memcpy(&word, bytes_.data.get() + i, sizeof word);
    hash = (hash ^ word) * kPrime;
    hash ^= hash >> 32;  // products never carry downwards
  }
  for (; i < bytes_.size; ++i) hash = (hash ^ bytes_.data[i]) * kPrime;
  return hash;
}

ModelFile::ModelFile(const std::string& path)
    : path_(path),
      name_(std::filesystem::path(path).stem().string()),
      bytes_(read(path)),
      model_(parse(path, bytes_)) {}

}  // namespace binpick::app
