// binpick info: what is in a model file.
#include <CLI/CLI.hpp>
#include <cinttypes>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "cli/model_summary.hpp"
#include "cli/symmetry_summary.hpp"
#include "model_file.hpp"

namespace binpick::app {
namespace {

struct InfoArguments {
  std::string model;
  bool json = false;
};

std::string hex(std::uint64_t value) {
  char text[20];
  std::snprintf(text, sizeof text, "%016" PRIx64, value);
  return text;
}

nlohmann::ordered_json to_json(const CountSummary& count) {
  return {{"min", count.min}, {"mean", count.mean}, {"max", count.max}};
}

nlohmann::ordered_json to_json(const ScoreCalibration& c) {
  return {{"slope", c.slope}, {"offset", c.offset}};
}

nlohmann::ordered_json to_json(const ModelTrials& t) {
  const SelfTestRecord& test = t.self_test;
  return {{"calibration_piles", t.calibration_piles},
          {"with_intensity", to_json(t.with_intensity)},
          {"depth_alone", to_json(t.depth_alone)},
          {"intensity_alone", to_json(t.intensity_alone)},
          {"variance_scale", t.variance_scale},
          {"variance_scale_intensity_alone", t.variance_scale_intensity_alone},
          {"self_test",
           {{"piles", test.piles},
            {"instances", test.instances},
            {"recall", test.recall},
            {"precision", test.precision},
            {"visible_fraction_min", test.visible_fraction_min}}}};
}

nlohmann::ordered_json to_json(const ModelFile& file) {
  const ModelInfo& i = file.model().info();
  nlohmann::ordered_json json = {{"file", file.path()},
                                 {"name", file.name()},
                                 {"size_bytes", file.size_bytes()},
                                 {"source_hash", hex(i.source_hash)},
                                 {"source_unit", unit_name(i.source_unit)},
                                 {"triangle_count", i.triangle_count},
                                 {"diameter_mm", i.diameter_mm},
                                 {"bounds_min_mm", i.bounds_min_mm},
                                 {"bounds_max_mm", i.bounds_max_mm},
                                 {"camera",
                                  {{"width", i.camera.width},
                                   {"height", i.camera.height},
                                   {"fx", i.camera.fx},
                                   {"fy", i.camera.fy},
                                   {"cx", i.camera.cx},
                                   {"cy", i.camera.cy}}},
                                 {"distance_min_mm", i.distance_min_mm},
                                 {"distance_max_mm", i.distance_max_mm},
                                 {"reference_distance_mm", i.reference_distance_mm},
                                 {"tilt_max_deg", i.tilt_max_deg},
                                 {"samples", i.samples},
                                 {"gradient_threshold", i.gradient_threshold},
                                 {"normal_threshold", i.normal_threshold},
                                 {"tilt_jitter_deg", i.tilt_jitter_deg},
                                 {"roll_jitter_deg", i.roll_jitter_deg},
                                 {"distance_jitter_mm", i.distance_jitter_mm},
                                 {"normal_codebook", codebook_name(i.normal_codebook)},
                                 {"seed", i.seed},
                                 {"base_level", i.base_level},
                                 {"scan_depth", i.scan_depth},
                                 {"symmetry", symmetry_json(file.model())},
                                 {"trials", to_json(file.model().trials())},
                                 {"depths", nlohmann::ordered_json::array()}};
  for (const DepthSummary& depth : summarize_depths(file.model())) {
    json["depths"].push_back({{"viewpoints", depth.viewpoints},
                              {"rolls", depth.rolls},
                              {"distances", depth.distances},
                              {"templates", depth.templates},
                              {"features", to_json(depth.features)},
                              {"children_per_viewpoint", to_json(depth.children)}});
  }
  return json;
}

void print_depths(const ObjectModel& model) {
  std::printf("\n%-6s %11s %6s %10s %10s %20s %20s\n", "depth", "viewpoints", "rolls", "distances",
              "templates", "features (min..max)", "children (min..max)");
  int number = 0;
  for (const DepthSummary& d : summarize_depths(model)) {
    std::printf("%-6d %11d %6d %10d %10zu %8.1f (%3d..%3d) %9.2f (%3d..%3d)%s\n", number,
                d.viewpoints, d.rolls, d.distances, d.templates, d.features.mean, d.features.min,
                d.features.max, d.children.mean, d.children.min, d.children.max,
                number == model.info().scan_depth ? "  scanned" : "");
    ++number;
  }
}

void print(const ModelTrials& t) {
  std::printf("%-20s ", "score");
  if (t.calibration_piles == 0) {
    std::printf("not calibrated\n");
  } else {
    std::printf(
        "calibrated on %d simulated piles: slope %.2f, offset %+.2f (depth alone %.2f, %+.2f; "
        "intensity alone %.2f, %+.2f)\n",
        t.calibration_piles, t.with_intensity.slope, t.with_intensity.offset, t.depth_alone.slope,
        t.depth_alone.offset, t.intensity_alone.slope, t.intensity_alone.offset);
  }
  std::printf("%-20s ", "self-test");
  const SelfTestRecord& test = t.self_test;
  if (test.piles == 0) {
    std::printf("none\n");
    return;
  }
  std::printf("recall %.3f, precision %.3f of %d parts in %d simulated piles", test.recall,
              test.precision, test.instances, test.piles);
  if (test.visible_fraction_min < 1) {
    std::printf("; half are found from %.0f %% visible", 100 * test.visible_fraction_min);
  }
  std::printf("\n");
}

void print(const ModelFile& file) {
  const ModelInfo& i = file.model().info();
  const auto line = [](const char* what) { std::printf("%-20s ", what); };
  std::printf("%s (%.1f MB)\n", file.path().c_str(), static_cast<double>(file.size_bytes()) * 1e-6);
  line("part");
  std::printf("%d triangles, diameter %.2f mm\n", i.triangle_count, i.diameter_mm);
  line("bounds");
  std::printf("(%.2f %.2f %.2f) to (%.2f %.2f %.2f) mm\n", i.bounds_min_mm[0], i.bounds_min_mm[1],
              i.bounds_min_mm[2], i.bounds_max_mm[0], i.bounds_max_mm[1], i.bounds_max_mm[2]);
  line("CAD file");
  std::printf("hash %s, unit %s\n", hex(i.source_hash).c_str(), unit_name(i.source_unit));
  line("camera");
  std::printf("%dx%d, fx %.3f, fy %.3f, cx %.3f, cy %.3f px\n", i.camera.width, i.camera.height,
              i.camera.fx, i.camera.fy, i.camera.cx, i.camera.cy);
  line("distance");
  std::printf("%.1f to %.1f mm, templates seen from %.1f mm\n", i.distance_min_mm,
              i.distance_max_mm, i.reference_distance_mm);
  line("tilt");
  std::printf("up to %.1f deg from the part's +z axis\n", i.tilt_max_deg);
  line("samples");
  std::printf("%d a template; thresholds %d (gradients), %d (normals); seed %" PRIu64 "\n",
              i.samples, i.gradient_threshold, i.normal_threshold, i.seed);
  line("jitter");
  std::printf("+-%.2f deg tilt, +-%.2f deg roll, +-%.1f mm distance\n", i.tilt_jitter_deg,
              i.roll_jitter_deg, i.distance_jitter_mm);
  line("normals");
  std::printf("%s codebook\n", codebook_name(i.normal_codebook));
  line("pyramid");
  std::printf("leaves at level %d, depth %d is scanned\n", i.base_level, i.scan_depth);
  const char* what = "symmetry";
  for (const std::string& text : symmetry_lines(file.model())) {
    line(what);
    std::printf("%s\n", text.c_str());
    what = "";
  }
  print(file.model().trials());
  print_depths(file.model());
}

}  // namespace

void add_info_command(CLI::App& app, int& exit_status) {
  auto arguments = std::make_shared<InfoArguments>();
  CLI::App& command = *app.add_subcommand("info", "Show what is in a model file");
  command.add_option("MODEL", arguments->model, "Model file, as train writes it")->required();
  command.add_flag("--json", arguments->json, "As JSON");
  command.callback([arguments, &exit_status] {
    const ModelFile file(arguments->model);
    if (arguments->json) {
      std::printf("%s\n", to_json(file).dump(2).c_str());
    } else {
      print(file);
    }
    exit_status = 0;
  });
}

}  // namespace binpick::app
