// Which hypotheses are near a place: a hash of square cells, so that suppression compares
// neighbours only.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "binpick/base/arena.hpp"
#include "binpick/geometry/pose.hpp"

namespace binpick {

class PlaceGrid {
 public:
  template <class Source>
  PlaceGrid(std::size_t entries_max, Source& source)
      : entries_(source.template take<Entry>(entries_max)) {}

  void clear() {
    heads_.fill(-1);
    count_ = 0;
  }

  // Entries are numbered in the order in which they come. Places in cells of a model.
  void add(int model, const Vec2& place) {
    const Entry entry{model, cell(place.x()), cell(place.y()), -1};
    std::int32_t& head = heads_[slot(entry.model, entry.x, entry.y)];
    entries_[static_cast<std::size_t>(count_)] = {entry.model, entry.x, entry.y, head};
    head = count_++;
  }

  // Entries of a model in the cell of a place and the eight around it; until `visit` says false.
  template <class Visit>
  void visit_near(int model, const Vec2& place, Visit&& visit) const {
    const int cx = cell(place.x()), cy = cell(place.y());
    for (int y = cy - 1; y <= cy + 1; ++y) {
      for (int x = cx - 1; x <= cx + 1; ++x) {
        for (std::int32_t i = heads_[slot(model, x, y)]; i >= 0;) {
          const Entry& e = entries_[static_cast<std::size_t>(i)];
          const bool here = e.model == model && e.x == x && e.y == y;
          if (here && !visit(static_cast<std::size_t>(i))) return;
          i = e.next;
        }
      }
    }
  }

 private:
  struct Entry {
    std::int32_t model, x, y, next;
  };
  static int cell(double place) { return static_cast<int>(std::floor(place)); }
  static std::size_t slot(int model, int x, int y) {
    const auto mixed = static_cast<std::uint32_t>(x) * 73856093u ^
                       static_cast<std::uint32_t>(y) * 19349663u ^
                       static_cast<std::uint32_t>(model) * 83492791u;
    return mixed % kSlots;
  }

  static constexpr std::size_t kSlots = 2048;
  std::array<std::int32_t, kSlots> heads_{};
  std::span<Entry> entries_;
  std::int32_t count_ = 0;
};

}  // namespace binpick
