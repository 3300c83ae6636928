// What is measured of a running station, as Prometheus reads it. Counters, gauges and histograms
// are atomics in memory of fixed size; a registry writes them as text when it is asked. Counting:
// any thread, no lock, nothing from the heap. Adding to a registry: set-up only.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "fixed_text.hpp"

namespace binpick::app {

class Counter {
 public:
  void add(std::uint64_t n = 1) { value_.fetch_add(n, std::memory_order_relaxed); }
  // Of something that counts itself.
  void set(std::uint64_t n) { value_.store(n, std::memory_order_relaxed); }
  std::uint64_t value() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> value_{0};
};

class Gauge {
 public:
  void set(double value) { value_.store(value, std::memory_order_relaxed); }
  double value() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<double> value_{0};
};

// Of times: from 1 ms to 10 s in steps of about 2. A reader may see a value counted and not yet
// summed.
class TimeHistogram {
 public:
  static constexpr std::array<double, 13> kBounds_ms = {1,   2,   5,    10,   20,   50,   100,
                                                        200, 500, 1000, 2000, 5000, 10000};
  void observe(double ms);
  // How many were not above bound i; i = kBounds_ms.size(): all.
  std::uint64_t count_up_to(std::size_t i) const;
  double sum_ms() const {
    return static_cast<double>(sum_us_.load(std::memory_order_relaxed)) / 1000;
  }

 private:
  std::array<std::atomic<std::uint64_t>, kBounds_ms.size() + 1> counts_{};
  std::atomic<std::uint64_t> sum_us_{0};
};

// The metrics by name. What is added outlives the registry; names and texts are literals. Metrics
// of one name are added one after the other, each with its labels (such as `cause="done"`).
class MetricRegistry {
 public:
  void add(const char* name, const char* help, const Counter& counter,
           const std::string& labels = "");
  void add(const char* name, const char* help, const Gauge& gauge, const std::string& labels = "");
  // Seconds, as is the custom.
  void add(const char* name, const char* help, const TimeHistogram& histogram,
           const std::string& labels = "");
  // Called before each writing: fetches what others count.
  void set_refresh(std::function<void()> refresh) { refresh_ = std::move(refresh); }

  // The text format, version 0.0.4. What does not fit is left out: text.whole() says so.
  void write(FixedText& text) const;
  // Enough for write(), whatever the values.
  std::size_t text_bytes_max() const;

 private:
  struct Metric {
    const char* name;
    const char* help;
    const char* type;
    std::string labels;
    const Counter* counter = nullptr;
    const Gauge* gauge = nullptr;
    const TimeHistogram* histogram = nullptr;
  };
  void add(const Metric& metric);

  std::vector<Metric> metrics_;
  std::function<void()> refresh_;
};

}  // namespace binpick::app
