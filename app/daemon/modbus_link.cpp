#include "daemon/modbus_link.hpp"

#include <pthread.h>

#include "daemon/answer_of_result.hpp"
#include "sensor/sensor_spec.hpp"

namespace binpick::app {
namespace {

namespace map = modbus::map;

// The register map promises a heartbeat every 200 ms at least.
constexpr int kLinkTurn_ms = 50;

template <class Bit>
std::uint16_t bit_if(bool set, Bit bit) {
  return set ? static_cast<std::uint16_t>(bit) : std::uint16_t{0};
}

}  // namespace

modbus::ServerConfig server_config_of(const ModbusConfig& config) {
  modbus::ServerConfig server;
  server.bind_address = config.bind;
  server.port = config.port;
  server.unit_id = static_cast<std::uint8_t>(config.unit_id);
  server.clients_max = config.clients_max;
  server.idle_timeout_ms = config.idle_timeout_ms;
  server.frame_timeout_ms = config.frame_timeout_ms;
  for (const std::string& network : config.allow)
    server.allow.push_back(modbus::parse_network(network));
  if (!config.writer.empty()) server.writer = modbus::parse_address(config.writer);
  server.plc_heartbeat_timeout_ms = config.plc_heartbeat_timeout_ms;
  return server;
}

ModbusLink::ModbusLink(const Config& config)
    : encoding_(config.modbus.encoding),
      simulated_(is_simulated(config.sensor)),
      server_(server_config_of(config.modbus), encoding_, image_, *this),
      flange_needed_(needs_flange_pose(config.station)) {
  publish();
}

ModbusLink::~ModbusLink() {
  stop();
}

void ModbusLink::start(Station& station, const SensorSession& session) {
  station_ = &station;
  session_ = &session;
  on_status(station.status());
  server_.start();
  thread_ = std::thread([this] { run(); });
}

void ModbusLink::stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(stop_mutex_);
    stopping_ = true;
  }
  stop_.notify_all();
  thread_.join();
  server_.stop();
}

void ModbusLink::run() {
  pthread_setname_np(pthread_self(), "modbus-link");
  std::unique_lock lock(stop_mutex_);
  while (!stop_.wait_for(lock, std::chrono::milliseconds(kLinkTurn_ms), [&] { return stopping_; }))
    turn();
}

// A heartbeat in the command's own write counts for the command.
void ModbusLink::put(const modbus::TakenCommand& command) {
  tell_heartbeat();
  station_->offer(order_of_command(command.registers, encoding_,
                                   flange_needed_.load(std::memory_order_relaxed),
                                   command.taken_ns));
}

// Looked at and told as one step: the server's thread and the link's do both.
void ModbusLink::tell_heartbeat() {
  const std::lock_guard lock(heartbeat_mutex_);
  station_->set_plc_lost(server_.plc_heartbeat() == modbus::Heartbeat::kLost);
}

void ModbusLink::turn() {
  tell_heartbeat();
  const std::lock_guard lock(publish_mutex_);
  ++answer_.station_heartbeat;
  publish();
}

void ModbusLink::on_status(const StationStatus& status) {
  const std::lock_guard lock(publish_mutex_);
  status_ = status;
  acknowledge(status);
  publish();
}

// publish_mutex_ is held.
void ModbusLink::acknowledge(const StationStatus& status) {
  if (status.order.source != OrderSource::kPlc) return;
  answer_.acknowledged_sequence = static_cast<std::uint16_t>(status.order.sequence);
  command_replaced_ = status.order_replaced_one;
}

void ModbusLink::on_result(const CycleResult& result, const StationStatus& status,
                           const FrameRef&) {
  const std::lock_guard lock(publish_mutex_);
  status_ = status;
  acknowledge(status);
  answer_.result_sequence = modbus::next_sequence(answer_.result_sequence);
  fill_answer(result, answer_);
  capture_ns_ = result.capture_ns;
  cut_short_ =
      (result.no_pick_reasons & static_cast<std::uint16_t>(map::NoPickReasonsBit::kDeadline)) != 0;
  publish();
}

std::uint16_t ModbusLink::state_bits() const {
  using map::StateBit;
  const bool sensor_ok = session_ != nullptr && session_->state() == SessionState::kReady;
  const bool fault = status_.state == StationState::kFault;
  const bool answered = answer_.result_sequence != 0;
  const bool current = answered && !status_.busy && answer_.result_command != 0 &&
                       answer_.result_command == answer_.acknowledged_sequence;
  return static_cast<std::uint16_t>(
      bit_if(sensor_ok && !fault && !status_.plc_lost, StateBit::kReady) |
      bit_if(status_.busy, StateBit::kBusy) |
      bit_if(status_.busy && status_.state == StationState::kComputing, StateBit::kFrameTaken) |
      bit_if(answered, StateBit::kResultValid) | bit_if(current, StateBit::kResultCurrent) |
      bit_if(cut_short_, StateBit::kCutShort) | bit_if(fault, StateBit::kFault) |
      bit_if(status_.free_running, StateBit::kFreeRunning) |
      bit_if(sensor_ok, StateBit::kSensorOk) |
      bit_if(status_.plc_lost, StateBit::kPlcHeartbeatLost) |
      bit_if(simulated_, StateBit::kSimulated) |
      bit_if(command_replaced_, StateBit::kCommandReplaced));
}

modbus::AnswerRegisters ModbusLink::registers() const {
  const std::lock_guard lock(publish_mutex_);
  return registers_;
}

void ModbusLink::publish() {
  answer_.state = state_bits();
  modbus::encode_answer(answer_, encoding_, registers_);
  image_.publish(registers_, capture_ns_);
}

}  // namespace binpick::app
