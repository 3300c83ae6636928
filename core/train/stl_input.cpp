#include "stl_input.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "binpick/geometry/pose.hpp"
#include "binpick/train/errors.hpp"

namespace binpick::train {
namespace {

constexpr std::size_t kCountAt = 80, kFacetsAt = 84, kFacetBytes = 50;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

char lower_case(char c) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

// The facet count of binary files has a zero byte in this part: no file that is read is so large.
bool is_text(std::string_view bytes) {
  std::string_view head = bytes.substr(0, kFacetsAt);
  if (head.find('\0') != head.npos) return false;
  if (head.starts_with(kByteOrderMark)) head.remove_prefix(kByteOrderMark.size());
  head.remove_prefix(std::min(head.find_first_not_of(" \t\r\n"), head.size()));
  constexpr std::string_view kFirstWord = "solid";
  return std::equal(
      kFirstWord.begin(), kFirstWord.end(), head.begin(),
      head.begin() + static_cast<std::ptrdiff_t>(std::min(head.size(), kFirstWord.size())),
      [](char a, char b) { return a == lower_case(b); });
}

std::string left_out(std::size_t bytes, const char* what) {
  if (bytes == 0) return "";
  return std::to_string(bytes) + (bytes == 1 ? " byte" : " bytes") + " after " + what + " left out";
}

std::string complete_text(std::string& bytes) {
  std::transform(bytes.begin(), bytes.end(), bytes.begin(), lower_case);
  bytes.erase(0, bytes.find("solid"));
  const std::size_t last_word = bytes.rfind("endsolid");
  if (last_word == bytes.npos) {
    throw ImportError("the file ends without the word endsolid, so it was cut short");
  }
  const std::size_t line_end = std::min(bytes.find_first_of("\r\n", last_word), bytes.size());
  if (bytes.find("facet", line_end) != bytes.npos) {
    throw ImportError("the last of its solids ends without the word endsolid, so it was cut short");
  }
  constexpr std::string_view kPadding(" \t\r\n\0\x1a", 6);
  const std::size_t rest = std::min(bytes.find_first_not_of(kPadding, line_end), bytes.size());
  const std::size_t rest_bytes = bytes.size() - rest;
  bytes.resize(line_end);
  return left_out(rest_bytes, "the last endsolid");
}

using Corners = std::array<Eigen::Vector3f, 3>;

Corners corners_of(std::string_view bytes, std::uint64_t facet) {
  Corners corners;
  std::memcpy(static_cast<void*>(corners.data()),
              bytes.data() + kFacetsAt + facet * kFacetBytes + 12, sizeof corners);
  return corners;
}

// Whether what stands behind the announced facets is another one, of the same part.
bool goes_on(std::string_view bytes, std::uint64_t count) {
  Eigen::AlignedBox3f box;
  for (std::uint64_t i = 0; i < count; ++i) {
    for (const Eigen::Vector3f& corner : corners_of(bytes, i)) {
      if (corner.allFinite()) box.extend(corner);
    }
  }
  const Corners next = corners_of(bytes, count);
  const float reach = box.isEmpty() ? 0 : box.diagonal().norm();
  const bool near = std::all_of(next.begin(), next.end(), [&](const Eigen::Vector3f& x) {
    return x.allFinite() && (box.isEmpty() || box.exteriorDistance(x) <= reach);
  });
  return near && (next[1] - next[0]).cross(next[2] - next[0]).norm() > 1e-6f * reach * reach;
}

std::string complete_binary(std::string& bytes) {
  if (bytes.size() < kFacetsAt) {
    throw ImportError(
        "it is no STL file: neither text that begins with the word solid, nor as "
        "long as the head of a binary file");
  }
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kCountAt, sizeof count);
  const std::uint64_t room = (bytes.size() - kFacetsAt) / kFacetBytes;
  const std::uint64_t end = kFacetsAt + count * std::uint64_t{kFacetBytes};
  const auto contradiction = [&](const char* what) {
    return "its head announces " + std::to_string(count) + " facets, but " + what +
           std::to_string(room);
  };
  if (count > room) {
    throw ImportError(contradiction("the file has room for ") +
                      ": it was cut short, or is no STL file; export it again");
  }
  if (room > count && goes_on(bytes, count)) {
    throw ImportError(contradiction("there are ") + ": export it again");
  }
  const std::uint64_t rest_bytes = bytes.size() - end;
  bytes.resize(end);
  return left_out(rest_bytes, "the last facet");
}

}  // namespace

std::string complete_stl(std::string& bytes) {
  return is_text(bytes) ? complete_text(bytes) : complete_binary(bytes);
}

}  // namespace binpick::train
