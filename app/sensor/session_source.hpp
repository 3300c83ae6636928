// A sensor session as the cycle's source of frames. Thread: the cycle's.
#pragma once

#include "sensor/sensor_session.hpp"
#include "station/cycle.hpp"

namespace binpick::app {

class SessionSource final : public FrameSource {
 public:
  explicit SessionSource(SensorSession& session) : session_(session) {}
  Result<FrameRef> grab(std::chrono::steady_clock::time_point deadline) override {
    return session_.grab(deadline);
  }

 private:
  SensorSession& session_;
};

}  // namespace binpick::app
