// Layout of a model file, version 5. Little-endian; every table starts at a multiple of 64 bytes
// from the start of the file. Written by core/train/model_writer, read in place by ObjectModel.
//
//   ModelHeader | Viewpoint tables (one per depth) | TemplateRange tables (one per depth)
//   | Feature table | sample table (floats) | viewing directions of the leaves (floats)
//   | SymmetryTurn table | SymmetryAxis table (exact rows first in both)
//
// Samples of a viewpoint are six arrays, one behind the other, each padded with zeros to a multiple
// of kSampleLanes: x, y, z and the direction's x, y, z. Viewing directions are three such arrays.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "binpick/model/object_model.hpp"

namespace binpick {

static_assert(std::endian::native == std::endian::little, "model files are read in place");

inline constexpr char kModelMagic[8] = {'B', 'I', 'N', 'P', 'I', 'C', 'K', 'M'};
inline constexpr std::uint32_t kModelVersion = 5;
inline constexpr std::size_t kModelAlignment = 64;
// A model beyond this was not made by this program.
inline constexpr std::uint64_t kModelBytesMax = 1ull << 30;

struct ModelTable {
  std::uint64_t offset_bytes = 0;
  std::uint64_t count = 0;
};

struct ModelDepthHeader {
  ModelTable viewpoints, templates;
  std::int32_t roll_count = 0, distance_count = 0;
};

struct ModelHeader {
  char magic[8];
  std::uint32_t version;
  std::uint32_t header_bytes;
  std::uint64_t file_bytes;
  std::uint64_t checksum;  // of everything behind this field
  ModelInfo info;
  ModelTrials trials;
  ModelDepthHeader depths[kModelDepthsMax];
  ModelTable features, samples, viewing_directions;
  ModelTable symmetry_turns, symmetry_axes;
};
static_assert(std::is_trivially_copyable_v<ModelHeader>);
static_assert(sizeof(Feature) == 6 && sizeof(TemplateRange) == 12 && sizeof(Viewpoint) == 72);
static_assert(sizeof(SymmetryTurn) == 44 && sizeof(SymmetryAxis) == 36);

inline constexpr std::size_t kChecksumFrom =
    offsetof(ModelHeader, checksum) + sizeof(std::uint64_t);

// FNV-1a over 64-bit words, the rest over bytes: detects any change of a bit, at memory speed.
inline std::uint64_t model_checksum(std::span<const std::uint8_t> bytes) {
  constexpr std::uint64_t kPrime = 0x100000001B3ull;
  std::uint64_t hash = 0xCBF29CE484222325ull;
  std::size_t i = 0;
  for (; i + 8 <= bytes.size(); i += 8) {
    std::uint64_t word = 0;
    for (int k = 7; k >= 0; --k) word = word << 8 | bytes[i + static_cast<std::size_t>(k)];
    hash = (hash ^ word) * kPrime;
    hash ^= hash >> 32;
  }
  for (; i < bytes.size(); ++i) hash = (hash ^ bytes[i]) * kPrime;
  return hash;
}

}  // namespace binpick
