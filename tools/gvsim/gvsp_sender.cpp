#include "gvsp_sender.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <thread>

namespace binpick::sim {
namespace {

using Clock = std::chrono::steady_clock;

// Packets of one system call: few enough that pauses between calls make a fair pace.
constexpr std::size_t kBatchMax = 32;
// Blocks kept for resending. Hosts give a frame up after 100 ms or so.
constexpr std::size_t kBlocksKept = 8;
// A host that asks for more at once is not answered for the rest; it asks again.
constexpr std::uint32_t kResendMax = 4096;
constexpr std::size_t kScratch = 9000;
constexpr std::size_t kSurplus = 16;

}  // namespace

struct GvspSender::Batch {
  GvspPacket packets[kBatchMax];
  mmsghdr messages[kBatchMax];
  std::uint8_t scratch[kBatchMax][kScratch + kSurplus];  // data of spoilt packets
  std::size_t count = 0;
};

GvspSender::GvspSender(in_addr address, const FaultBoard& faults, double link_mbps,
                       std::uint64_t seed)
    : faults_(faults),
      ns_per_byte_(link_mbps > 0 ? 8000 / link_mbps : 0),
      send_dice_(seed),
      resend_dice_(seed + 1),
      send_batch_(std::make_unique<Batch>()),
      resend_batch_(std::make_unique<Batch>()) {
  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in local{};
  local.sin_family = AF_INET;
  local.sin_addr = address;
  socklen_t size = sizeof local;
  auto* generic = reinterpret_cast<sockaddr*>(&local);
  if (socket_ < 0 || bind(socket_, generic, size) != 0 ||
      getsockname(socket_, generic, &size) != 0) {
    const std::string reason = std::strerror(errno);
    if (socket_ >= 0) close(socket_);
    throw std::runtime_error("no stream socket can be opened (" + reason + ")");
  }
  const int send_buffer = 4 << 20;
  setsockopt(socket_, SOL_SOCKET, SO_SNDBUF, &send_buffer, sizeof send_buffer);
  port_ = ntohs(local.sin_port);
}

GvspSender::~GvspSender() {
  close(socket_);
}

void GvspSender::set_fragmentation(bool do_not_fragment) {
  const std::lock_guard guard(mutex_);
  if (fragmentation_ == (do_not_fragment ? 1 : 0)) return;
  const int mode = do_not_fragment ? IP_PMTUDISC_DO : IP_PMTUDISC_DONT;
  setsockopt(socket_, IPPROTO_IP, IP_MTU_DISCOVER, &mode, sizeof mode);
  fragmentation_ = do_not_fragment ? 1 : 0;
}

std::vector<std::uint32_t> GvspSender::sending_order(const GvspBlock& block) {
  std::vector<std::uint32_t> order;
  order.reserve(block.packet_count() + 16);
  for (std::uint32_t number = 0; number < block.packet_count(); ++number) {
    if (send_dice_.falls(faults_.value(kLoss))) {
      ++counters_.lost;
      continue;
    }
    order.push_back(number);
    if (send_dice_.falls(faults_.value(kDuplicate))) order.push_back(number);
  }
  for (std::size_t i = 0; i + 1 < order.size(); ++i) {
    if (send_dice_.falls(faults_.value(kReorder))) std::swap(order[i], order[i + 1]);
  }
  return order;
}

// Changes a packet that was built. Leaders and trailers keep their numbers and contents.
void GvspSender::spoil(GvspPacket& packet, Dice& dice, std::uint8_t* scratch) {
  if (packet.piece_count < 2) return;
  if (dice.falls(faults_.value(kWrongId))) {
    const bool extended = (packet.head[4] & 0x80) != 0;
    packet.head[extended ? 19 : 7] ^= 0x05;
  }
  const bool truncate = dice.falls(faults_.value(kTruncate));
  const bool corrupt = dice.falls(faults_.value(kCorrupt));
  const bool wrong_size = dice.falls(faults_.value(kWrongSize));
  if (!truncate && !corrupt && !wrong_size) return;
  std::size_t bytes = 0;
  for (std::size_t i = 1; i < packet.piece_count; ++i) {
    std::memcpy(scratch + bytes, packet.pieces[i].iov_base, packet.pieces[i].iov_len);
    bytes += packet.pieces[i].iov_len;
  }
  if (corrupt) {
    for (std::size_t i = 0; i < bytes; ++i) scratch[i] ^= 0xff;
  }
  if (wrong_size) {
    std::memset(scratch + bytes, 0xaa, kSurplus);
    bytes += kSurplus;
  }
  if (truncate) bytes /= 2;
  packet.begin(packet.head_bytes);
  packet.append(scratch, bytes);
}

void GvspSender::flush(Batch& batch, const Target& target) {
  for (std::size_t i = 0; i < batch.count; ++i) {
    msghdr& header = batch.messages[i].msg_hdr;
    header = {};
    header.msg_name = const_cast<sockaddr_in*>(&target.address);
    header.msg_namelen = sizeof target.address;
    header.msg_iov = batch.packets[i].pieces;
    header.msg_iovlen = batch.packets[i].piece_count;
  }
  std::size_t done = 0;
  while (done < batch.count) {
    const int sent =
        sendmmsg(socket_, batch.messages + done, static_cast<unsigned>(batch.count - done), 0);
    if (sent > 0) {
      done += static_cast<std::size_t>(sent);
      counters_.packets += static_cast<std::uint64_t>(sent);
    } else if (errno != EINTR) {
      ++done;  // too large for the link, or nobody there: as lost as on a real one
      ++counters_.not_sent;
    }
  }
  batch.count = 0;
}

void GvspSender::send(std::shared_ptr<const GvspBlock> block, const Target& target) {
  set_fragmentation(target.do_not_fragment);
  {
    const std::lock_guard guard(mutex_);
    blocks_.push_front(block);
    if (blocks_.size() > kBlocksKept) blocks_.pop_back();
  }
  const double link_ns = ns_per_byte_ * block->format().packet_size;
  const auto delay_ns =
      static_cast<std::uint64_t>(std::max(link_ns, static_cast<double>(target.packet_delay_ns)));
  // Long delays between packets would lump if many of them went in one call.
  const std::size_t batch_size = delay_ns > 100000  ? 1
                                 : delay_ns > 20000 ? kBatchMax / 4
                                                    : kBatchMax;
  const Clock::time_point begin = Clock::now();
  std::uint64_t queued = 0;
  Batch& batch = *send_batch_;
  for (const std::uint32_t number : sending_order(*block)) {
    if (faults_.on(kFrozen)) break;
    GvspPacket& packet = batch.packets[batch.count];
    block->build(number, packet);
    spoil(packet, send_dice_, batch.scratch[batch.count]);
    ++batch.count;
    ++queued;
    if (batch.count < batch_size) continue;
    flush(batch, target);
    if (delay_ns > 0)
      std::this_thread::sleep_until(begin + std::chrono::nanoseconds(queued * delay_ns));
  }
  flush(batch, target);
}

void GvspSender::resend(const Target& target, std::uint64_t block_id, std::uint32_t first,
                        std::uint32_t last, bool extended_ids) {
  std::shared_ptr<const GvspBlock> block;
  {
    const std::lock_guard guard(mutex_);
    const auto found = std::find_if(blocks_.begin(), blocks_.end(), [&](const auto& kept) {
      return kept->id() == block_id && kept->format().extended_ids == extended_ids;
    });
    if (found != blocks_.end()) block = *found;
  }
  if (last < first) return;
  last = std::min(last, first + kResendMax);
  Batch& batch = *resend_batch_;
  for (std::uint32_t number = first; number <= last; ++number) {
    GvspPacket& packet = batch.packets[batch.count];
    if (block == nullptr || number >= block->packet_count()) {
      build_unavailable_packet(block_id, number, extended_ids, packet);
      ++counters_.unavailable;
    } else {
      ++counters_.resent;
      if (resend_dice_.falls(faults_.value(kLoss))) continue;
      block->build(number, packet);
      spoil(packet, resend_dice_, batch.scratch[batch.count]);
    }
    if (++batch.count == kBatchMax) flush(batch, target);
    if (block == nullptr) break;  // one answer for the whole block is enough
  }
  flush(batch, target);
}

void GvspSender::send_test_packet(const Target& target, std::uint32_t packet_size) {
  set_fragmentation(target.do_not_fragment);
  std::vector<std::uint8_t> bytes(packet_size - kUdpOverhead, 0);
  for (std::size_t i = 8; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i);
  const ssize_t sent =
      sendto(socket_, bytes.data(), bytes.size(), 0,
             reinterpret_cast<const sockaddr*>(&target.address), sizeof target.address);
  if (sent < 0) ++counters_.not_sent;
}

void GvspSender::forget_blocks() {
  const std::lock_guard guard(mutex_);
  blocks_.clear();
}

}  // namespace binpick::sim
