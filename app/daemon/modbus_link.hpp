// Between the station and its Modbus server: commands become orders, answers and states become
// registers. Commands are handed on by the server's thread, answers published by the cycle's; the
// link's own keeps the station's heartbeat moving and watches the PLC's. Allocates nothing after
// start().
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "modbus/server.hpp"
#include "sensor/sensor_session.hpp"
#include "station/station.hpp"

namespace binpick::app {

modbus::ServerConfig server_config_of(const ModbusConfig& config);

class ModbusLink final : public StationSink, private modbus::CommandSink {
 public:
  // Binds and listens; throws SetupError.
  explicit ModbusLink(const Config& config);
  ~ModbusLink() override;
  ModbusLink(const ModbusLink&) = delete;
  ModbusLink& operator=(const ModbusLink&) = delete;

  // Both outlive stop().
  void start(Station& station, const SensorSession& session);
  void stop();

  void on_status(const StationStatus& status) override;
  void on_result(const CycleResult& result, const StationStatus& status,
                 const FrameRef& kept_frame) override;

  // What the command registers' flange pose is read for; may change with a reload.
  void set_flange_needed(bool needed) { flange_needed_.store(needed, std::memory_order_relaxed); }
  // As published last.
  modbus::AnswerRegisters registers() const;
  int port() const { return server_.port(); }
  const modbus::Server& server() const { return server_; }

 private:
  void put(const modbus::TakenCommand& command) override;
  void run();
  void turn();
  void tell_heartbeat();
  // publish_mutex_ is held.
  void acknowledge(const StationStatus& status);
  void publish();
  std::uint16_t state_bits() const;

  const modbus::Encoding encoding_;
  const bool simulated_;
  modbus::AnswerImage image_;
  modbus::Server server_;
  Station* station_ = nullptr;
  const SensorSession* session_ = nullptr;
  std::atomic<bool> flange_needed_;

  std::mutex heartbeat_mutex_;
  mutable std::mutex publish_mutex_;  // the cycle's thread and this link's publish
  modbus::AnswerSnapshot answer_;
  modbus::AnswerRegisters registers_{};
  std::int64_t capture_ns_ = 0;
  StationStatus status_;
  bool cut_short_ = false;
  bool command_replaced_ = false;

  std::mutex stop_mutex_;
  std::condition_variable stop_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace binpick::app
