#include "daemon/result_board.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>

#include "setup_error.hpp"

namespace binpick::app {

std::size_t ResultBoard::footprint(int picks_max) {
  return kSources * Arena::padded(static_cast<std::size_t>(picks_max) * sizeof(Pick));
}

ResultBoard::ResultBoard(int picks_max, Arena& arena)
    : descriptor_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (descriptor_ < 0) throw SetupError("no event descriptor can be had");
  for (Entry& entry : entries_) entry.picks = arena.take<Pick>(static_cast<std::size_t>(picks_max));
}

ResultBoard::~ResultBoard() {
  close(descriptor_);
}

void ResultBoard::on_result(const CycleResult& result, const StationStatus&, const FrameRef&) {
  {
    const std::lock_guard lock(mutex_);
    Entry& entry = entries_[static_cast<std::size_t>(result.order.source)];
    ++entry.number;
    entry.result = result;
    BINPICK_ASSERT(result.picks.size() <= entry.picks.size());
    std::copy(result.picks.begin(), result.picks.end(), entry.picks.begin());
    entry.result.picks = entry.picks.first(result.picks.size());
  }
  eventfd_write(descriptor_, 1);
}

void ResultBoard::clear_event() {
  eventfd_t count = 0;
  eventfd_read(descriptor_, &count);
}

ResultBoard::Brief ResultBoard::brief(OrderSource source) const {
  const std::lock_guard lock(mutex_);
  const Entry& entry = entries_[static_cast<std::size_t>(source)];
  Brief brief{entry.number, entry.result, entry.result.picks.size()};
  brief.result.picks = {};
  return brief;
}

ResultBoard::Copy ResultBoard::last(OrderSource source) const {
  Copy copy;
  const std::lock_guard lock(mutex_);
  const Entry& entry = entries_[static_cast<std::size_t>(source)];
  copy.result = entry.result;
  copy.picks.assign(entry.result.picks.begin(), entry.result.picks.end());
  copy.result.picks = copy.picks;
  return copy;
}

}  // namespace binpick::app
