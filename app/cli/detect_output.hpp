// What `binpick detect` hands out: a table for people, JSON for scripts, a picture for both.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "binpick/check/frame_check.hpp"
#include "binpick/detect/detector.hpp"
#include "binpick/train/mesh.hpp"
#include "model_file.hpp"

namespace binpick::app {

// Everything that a run was made from, beside its report.
struct DetectRun {
  std::span<const ModelFile> files;
  Frame frame;
  std::string frame_name;
  DetectorParams params;
  DetectRequest request;
  int threads = 1;
  FrameFindings findings;  // of the frame, before the search

  std::vector<std::string> model_names() const;
  std::string part_name(int model) const { return files[static_cast<std::size_t>(model)].name(); }
};

void print_report(const DetectRun& run, const DetectionReport& report);

std::string report_json(const DetectRun& run, const DetectionReport& report);

// Outlines come from the meshes, one for each model; without any, from the contours in the models.
// Throws RenderError, or SetupError naming the file.
void write_overlay(const DetectRun& run, const DetectionReport& report,
                   std::span<const train::Mesh> meshes, const std::string& path);

}  // namespace binpick::app
