#include <algorithm>

#include "eval/score.hpp"

namespace binpick::app {
namespace {

template <class T>
void add_scaled(T& sum, const T& value, double share) {
  sum.f1 += share * value.f1;
  sum.recall += share * value.recall;
}

// Means over the parts that were timed.
std::optional<TimeSummary> mean_time(const std::vector<PartScore>& parts) {
  TimeSummary mean;
  int timed = 0;
  for (const PartScore& p : parts) {
    if (p.time.count == 0) continue;
    ++timed;
    mean.count += p.time.count;
    mean.mean_s += p.time.mean_s;
    mean.p50_s += p.time.p50_s;
    mean.p99_s += p.time.p99_s;
    mean.max_s = std::max(mean.max_s, p.time.max_s);
  }
  if (timed == 0) return std::nullopt;
  mean.mean_s /= timed;
  mean.p50_s /= timed;
  mean.p99_s /= timed;
  return mean;
}

// Over the parts of which any pose was right.
std::optional<PoseError6> mean_error(const std::vector<PartScore>& parts) {
  PoseError6 sum{};
  int count = 0;
  for (const PartScore& p : parts) {
    if (!p.mean_abs_error) continue;
    ++count;
    for (int i = 0; i < 6; ++i) sum[i] += (*p.mean_abs_error)[i];
  }
  if (count == 0) return std::nullopt;
  for (double& s : sum) s /= count;
  return sum;
}

}  // namespace

std::optional<MeanScore> mean_of(const std::vector<PartScore>& parts) {
  if (parts.empty()) return std::nullopt;
  MeanScore mean;
  const double share = 1.0 / static_cast<double>(parts.size());
  for (const PartScore& p : parts) {
    add_scaled(mean.best, p.best, share);
    mean.best.precision += share * p.best.precision;
    add_scaled(mean.add10, p.add10, share);
    add_scaled(mean.add15, p.add15, share);
    mean.mssd_recall += share * p.mssd_recall;
    if (p.fixed) mean.fixed_f1 = mean.fixed_f1.value_or(0.0) + share * p.fixed->f1;
  }
  mean.mean_abs_error = mean_error(parts);
  mean.time = mean_time(parts);
  return mean;
}

}  // namespace binpick::app
