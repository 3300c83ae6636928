// Rows of a model file's symmetry tables, and a file that says so of any part.
#pragma once

#include <cstring>
#include <vector>

#include "bracket.hpp"
#include "model/model_format.hpp"

namespace binpick {

inline SymmetryTurn turn_row(const Vec3& axis, double angle_deg, double x_mm = 0,
                             SymmetryKind kind = SymmetryKind::kExact) {
  SymmetryTurn t{};
  t.kind = kind;
  for (int i = 0; i < 3; ++i) t.axis[i] = static_cast<float>(axis[i]);
  t.point_mm[0] = static_cast<float>(x_mm);
  t.angle_rad = static_cast<float>(angle_deg * kDegree);
  return t;
}

inline SymmetryAxis axis_row(const Vec3& axis, double x_mm = 0,
                             SymmetryKind kind = SymmetryKind::kExact) {
  SymmetryAxis a{};
  a.kind = kind;
  for (int i = 0; i < 3; ++i) a.axis[i] = static_cast<float>(axis[i]);
  a.point_mm[0] = static_cast<float>(x_mm);
  return a;
}

template <class Row>
ModelTable appended_table(std::vector<std::uint8_t>& bytes, const std::vector<Row>& rows) {
  bytes.resize((bytes.size() + kModelAlignment - 1) / kModelAlignment * kModelAlignment);
  const ModelTable table{bytes.size(), rows.size()};
  bytes.resize(bytes.size() + rows.size() * sizeof(Row));
  if (!rows.empty())
    std::memcpy(bytes.data() + table.offset_bytes, rows.data(), rows.size() * sizeof(Row));
  return table;
}

// The model file with these rows instead of its own.
inline std::vector<std::uint8_t> with_symmetry(std::vector<std::uint8_t> bytes,
                                               const std::vector<SymmetryTurn>& turns,
                                               const std::vector<SymmetryAxis>& axes) {
  const ModelTable turn_table = appended_table(bytes, turns),
                   axis_table = appended_table(bytes, axes);
  auto& header = *reinterpret_cast<ModelHeader*>(bytes.data());
  header.symmetry_turns = turn_table;
  header.symmetry_axes = axis_table;
  header.file_bytes = bytes.size();
  header.checksum = model_checksum(std::span(bytes).subspan(kChecksumFrom));
  return bytes;
}

}  // namespace binpick
