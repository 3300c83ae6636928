#include "cli/drop_table.hpp"

#include <cstdio>

namespace binpick::app {

void print_drops(const drivers::CameraCounters& c) {
  const auto number = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
  std::printf("frames %llu, dropped %llu", number(c.frames), number(c.dropped_total()));
  for (int r = 1; r < drivers::kDropReasonCount; ++r) {
    const auto reason = static_cast<drivers::DropReason>(r);
    if (c.dropped_count(reason) > 0)
      std::printf(", %s %llu", drivers::drop_reason_name(reason), number(c.dropped_count(reason)));
  }
  std::printf(", missed %llu; packets asked for again %llu, missing %llu; underruns %llu\n",
              number(c.frames_missed), number(c.packets_resent), number(c.packets_missing),
              number(c.underruns));
}

}  // namespace binpick::app
