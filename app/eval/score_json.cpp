#include "eval/score_json.hpp"

#include <nlohmann/json.hpp>

namespace binpick::app {
namespace {

using nlohmann::json;

template <class T>
json or_null(const std::optional<T>& value) {
  return value ? json(*value) : json();
}

void put_time(json& out, const TimeSummary& time) {
  const bool known = time.count > 0;
  out["time_mean"] = known ? json(time.mean_s) : json();
  out["time_p50"] = known ? json(time.p50_s) : json();
  out["time_p99"] = known ? json(time.p99_s) : json();
  out["time_max"] = known ? json(time.max_s) : json();
}

// The fields that a part and a mean share.
template <class Score>
json common_fields(const Score& s) {
  json out{{"f1", s.best.f1}, {"recall", s.best.recall}, {"precision", s.best.precision}};
  out["mean_abs_error"] = or_null(s.mean_abs_error);
  out["add10_f1"] = s.add10.f1;
  out["add10_recall"] = s.add10.recall;
  out["add15_f1"] = s.add15.f1;
  out["add15_recall"] = s.add15.recall;
  out["mssd_recall"] = s.mssd_recall;
  return out;
}

json part_to_json(const PartScore& p) {
  json out = common_fields(p);
  out["obj_id"] = p.obj_id;
  out["mixed_scene"] = or_null(p.mixed_scene);
  out["images"] = p.frames.size();
  out["instances"] = p.instances;
  out["detections"] = p.detections;
  out["threshold"] = or_null(p.best.threshold);
  if (p.fixed) {
    out["fixed"] = {{"f1", p.fixed->f1},
                    {"recall", p.fixed->recall},
                    {"precision", p.fixed->precision},
                    {"threshold", or_null(p.fixed->threshold)}};
  }
  put_time(out, p.time);
  return out;
}

json mean_to_json(const std::optional<MeanScore>& mean) {
  if (!mean) return {};
  json out = common_fields(*mean);
  if (mean->fixed_f1) out["fixed"] = {{"f1", *mean->fixed_f1}};
  put_time(out, mean->time.value_or(TimeSummary{}));
  return out;
}

json parts_to_json(const std::vector<PartScore>& parts) {
  json list = json::array();
  for (const PartScore& p : parts) list.push_back(part_to_json(p));
  return list;
}

}  // namespace

json score_to_json(const ScoreReport& report) {
  return {{"criterion",
           {{"mm", report.options.limits.mm},
            {"deg", report.options.limits.deg},
            {"min_visib_fract", report.options.visible_min}}},
          {"parts", parts_to_json(report.parts)},
          {"mean", mean_to_json(report.mean)},
          {"mixed", parts_to_json(report.mixed)},
          {"mixed_mean", mean_to_json(report.mixed_mean)}};
}

}  // namespace binpick::app
