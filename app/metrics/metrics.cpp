#include "metrics/metrics.hpp"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstring>

#include "binpick/base/assert.hpp"

namespace binpick::app {
namespace {

// `{a="b"}`, with `le` where it is not null; nothing where there is neither.
void write_labels(FixedText& text, const std::string& labels, const char* le = nullptr) {
  if (labels.empty() && le == nullptr) return;
  text.print("{%s", labels.c_str());
  if (le != nullptr) text.print("%sle=\"%s\"", labels.empty() ? "" : ",", le);
  text.add("}");
}

void write_histogram(FixedText& text, const char* name, const std::string& labels,
                     const TimeHistogram& histogram) {
  constexpr std::size_t kBounds = TimeHistogram::kBounds_ms.size();
  std::uint64_t count = 0;
  for (std::size_t i = 0; i <= kBounds; ++i) {
    char bound[16] = "+Inf";
    if (i < kBounds) std::snprintf(bound, sizeof bound, "%g", TimeHistogram::kBounds_ms[i] / 1000);
    // Counted on while it is read: never fewer than the bound below.
    count = std::max(count, histogram.count_up_to(i));
    text.print("%s_bucket", name);
    write_labels(text, labels, bound);
    text.print(" %" PRIu64 "\n", count);
  }
  text.print("%s_sum", name);
  write_labels(text, labels);
  text.print(" %.6f\n%s_count", histogram.sum_ms() / 1000, name);
  write_labels(text, labels);
  text.print(" %" PRIu64 "\n", count);
}

}  // namespace

void TimeHistogram::observe(double ms) {
  if (!(ms >= 0) || !std::isfinite(ms)) return;
  const auto bound = std::lower_bound(kBounds_ms.begin(), kBounds_ms.end(), ms);
  counts_[static_cast<std::size_t>(bound - kBounds_ms.begin())].fetch_add(
      1, std::memory_order_relaxed);
  sum_us_.fetch_add(static_cast<std::uint64_t>(std::min(ms, 1e9) * 1000),
                    std::memory_order_relaxed);
}

std::uint64_t TimeHistogram::count_up_to(std::size_t i) const {
  std::uint64_t sum = 0;
  for (std::size_t k = 0; k <= i; ++k) sum += counts_[k].load(std::memory_order_relaxed);
  return sum;
}

void MetricRegistry::add(const Metric& metric) {
  for (const Metric& other : metrics_)
    BINPICK_ASSERT(
        std::strcmp(other.name, metric.name) != 0 ||
        (other.labels != metric.labels && std::strcmp(metrics_.back().name, metric.name) == 0));
  metrics_.push_back(metric);
}

void MetricRegistry::add(const char* name, const char* help, const Counter& counter,
                         const std::string& labels) {
  add({name, help, "counter", labels, &counter});
}
void MetricRegistry::add(const char* name, const char* help, const Gauge& gauge,
                         const std::string& labels) {
  add({name, help, "gauge", labels, nullptr, &gauge});
}
void MetricRegistry::add(const char* name, const char* help, const TimeHistogram& histogram,
                         const std::string& labels) {
  add({name, help, "histogram", labels, nullptr, nullptr, &histogram});
}

void MetricRegistry::write(FixedText& text) const {
  if (refresh_) refresh_();
  const char* last = "";
  for (const Metric& m : metrics_) {
    if (std::strcmp(m.name, last) != 0)
      text.print("# HELP %s %s\n# TYPE %s %s\n", m.name, m.help, m.name, m.type);
    last = m.name;
    if (m.histogram != nullptr) {
      write_histogram(text, m.name, m.labels, *m.histogram);
      continue;
    }
    text.add(m.name);
    write_labels(text, m.labels);
    if (m.counter != nullptr)
      text.print(" %" PRIu64 "\n", m.counter->value());
    else
      text.print(" %.17g\n", m.gauge->value());
  }
}

std::size_t MetricRegistry::text_bytes_max() const {
  constexpr std::size_t kNumberAndMarks = 48;
  std::size_t bytes = 1;
  for (const Metric& m : metrics_) {
    const std::size_t name = std::strlen(m.name);
    const std::size_t lines = m.histogram != nullptr ? TimeHistogram::kBounds_ms.size() + 3 : 1;
    bytes += 2 * name + std::strlen(m.help) + kNumberAndMarks;
    bytes += lines * (name + m.labels.size() + kNumberAndMarks);
  }
  return bytes;
}

}  // namespace binpick::app
