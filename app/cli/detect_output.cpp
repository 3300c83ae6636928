#include "cli/detect_output.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "binpick/geometry/angle.hpp"
#include "detection_json.hpp"
#include "frame_findings.hpp"
#include "overlay/overlay.hpp"
#include "replace_file.hpp"

namespace binpick::app {
namespace {

using nlohmann::ordered_json;

const char* layout_name(MapLayout layout) {
  return layout == MapLayout::kPlain ? "plain" : "rearranged";
}

ordered_json frame_json(const DetectRun& run) {
  const CameraIntrinsics& c = run.frame.camera;
  ordered_json json = {{"name", run.frame_name},
                       {"width", c.width},
                       {"height", c.height},
                       {"fx", c.fx},
                       {"fy", c.fy},
                       {"cx", c.cx},
                       {"cy", c.cy}};
  const Roi& roi = run.frame.roi;
  if (!roi.whole_image()) json["roi"] = {roi.x, roi.y, roi.width, roi.height};
  return json;
}

ordered_json settings_json(const DetectRun& run) {
  ordered_json json = {
      {"layout", layout_name(run.params.layout)},
      {"isa", isa_name(run.params.isa)},
      {"threads", run.threads},
      {"modality", kModalityNames[static_cast<int>(run.request.modality)]},
      {"near_symmetry", kNearSymmetryNames[static_cast<int>(run.request.near_symmetry)]},
      {"max_results", run.request.max_results},
      {"min_score", run.request.min_score}};
  for (const ModelFile& file : run.files) {
    json["models"].push_back({{"name", file.name()}, {"file", file.path()}});
  }
  return json;
}

void print_times(const DetectionReport& report) {
  std::printf("\n%.1f ms in all:", report.total_ms);
  for (int i = 0; i < kStageCount; ++i) {
    std::printf(" %s %.1f", stage_name(static_cast<Stage>(i)), report.stage_ms[i]);
  }
  std::printf("\n%-6s %14s %12s %8s\n", "depth", "templates", "candidates", "ms");
  for (int d = 0; d < report.level_count; ++d) {
    std::printf("%-6d %14lld %12d %8.1f\n", d,
                static_cast<long long>(report.templates_evaluated[d]), report.candidates[d],
                report.level_ms[d]);
  }
  std::printf("dropped:");
  for (int i = 0; i < kDropReasonCount; ++i) {
    if (report.dropped[i] == 0) continue;
    std::printf(" %s %d", drop_reason_name(static_cast<DropReason>(i)), report.dropped[i]);
  }
  std::printf("\n");
}

}  // namespace

std::vector<std::string> DetectRun::model_names() const {
  std::vector<std::string> names;
  for (const ModelFile& file : files) names.push_back(file.name());
  return names;
}

// A standard deviation along the direction that is held least.
std::string held(double deviation, bool observable) {
  char text[16];
  std::snprintf(text, sizeof text, "%.2f", deviation);
  return observable ? text : "loose";
}

void print_findings(const DetectRun& run) {
  const auto name = [&](int model) { return run.part_name(model); };
  for (const Finding& finding : run.findings.found())
    std::printf("warning: %s\n", finding_text(finding, name).c_str());
}

void print_why_none(const DetectRun& run, const DetectionReport& report) {
  if (!report.best_rejected) {
    if (run.findings.count == 0) std::printf("nothing in the frame resembles the part\n");
    return;
  }
  const auto& [pose, reason] = *report.best_rejected;
  const Vec3& t = pose.T_cam_obj.t_mm;
  std::printf("best rejected pose: %s at %.1f %.1f %.1f mm, score %.3f (needed: %.3g), %s\n",
              run.part_name(pose.model_index).c_str(), t.x(), t.y(), t.z(), pose.score,
              run.request.min_score, drop_reason_name(reason));
}

void print_report(const DetectRun& run, const DetectionReport& report) {
  std::printf("%s: %zu found\n", run.frame_name.c_str(), report.detections.size());
  print_findings(run);
  if (report.detections.empty()) print_why_none(run, report);
  if (!report.detections.empty()) {
    std::printf("%4s %-16s %6s %27s %35s %6s %6s %6s %7s %7s %7s\n", "", "part", "score",
                "x, y, z (mm)", "quaternion w, x, y, z", "seen", "depth", "edges", "res(mm)",
                "+-mm", "+-deg");
  }
  int number = 0;
  for (const Detection& d : report.detections) {
    const std::array<double, 4> q = quaternion_wxyz(d.T_cam_obj.R);
    const Vec3& t = d.T_cam_obj.t_mm;
    const PoseUncertainty& u = d.uncertainty;
    std::printf(
        "%4d %-16s %6.3f %8.2f %8.2f %9.2f %8.4f %8.4f %8.4f %8.4f %6.2f %6.2f %6.2f %7.2f %7s "
        "%7s\n",
        number++, run.files[static_cast<std::size_t>(d.model_index)].name().c_str(), d.score, t.x(),
        t.y(), t.z(), q[0], q[1], q[2], q[3], d.visible_fraction, d.depth_support,
        d.contour_support, d.depth_residual_mm, held(u.weak_shift_mm, u.shift_observable).c_str(),
        held(u.weak_turn_rad / kDegree, u.turn_observable).c_str());
    if (pose_ambiguous(d)) {
      std::printf(
          "%4s ambiguous: the part looks the same in other poses; this one is right with "
          "%.0f %%\n",
          "", 100 * d.pose_probability);
    }
  }
  print_times(report);
}

std::string report_json(const DetectRun& run, const DetectionReport& report) {
  ordered_json json = {{"frame", frame_json(run)}, {"settings", settings_json(run)}};
  json["diagnostics"] = to_json(run.findings, [&](int model) { return run.part_name(model); });
  json.update(to_json(report, run.model_names()));
  return json.dump(2) + "\n";
}

void write_overlay(const DetectRun& run, const DetectionReport& report,
                   std::span<const train::Mesh> meshes, const std::string& path) {
  std::vector<OverlayItem> items;
  for (const Detection& d : report.detections) {
    OverlayItem item;
    const std::size_t model = static_cast<std::size_t>(d.model_index);
    item.T_cam_obj = d.T_cam_obj;
    if (meshes.empty()) {
      item.model = &run.files[model].model();
    } else {
      item.mesh = &meshes[model];
    }
    item.score = d.score;
    if (run.files.size() > 1) item.label = run.files[model].name();
    items.push_back(item);
  }
  OverlayPainter painter(run.frame.camera);
  replace_file(path, encode_png(painter.paint(background_of(run.frame), items)));
}

}  // namespace binpick::app
