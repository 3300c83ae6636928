// OpenCV's LINEMOD and PPF (surface_matching) on the single-part scenes of a data set, on one
// thread, each followed by the same ICP and the same check against the depth image.
//   peers_bench DATASET OUT
// writes OUT/linemod.csv and OUT/ppf.csv, poses as BOP tools read them, and OUT/peers.json: ms of
// each frame, until matched and in all.
// What limits the comparison: the searches run with settings close to their defaults (LINEMOD with
// 6480 templates a part, every 17 degrees of view and 18 of roll, where binpick has 41000; PPF's
// points are as dense as training takes some seconds for). ICP is OpenCV's; the check and its
// limits are ours, and nobody tuned them.
#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/rgbd/linemod.hpp>
#include <opencv2/surface_matching.hpp>
#include <optional>

#include "bench/peers/pose_refiner.hpp"
#include "binpick/geometry/angle.hpp"
#include "clock.hpp"
#include "eval/bop_results.hpp"
#include "eval/distance_range.hpp"
#include "eval/eval_plan.hpp"
#include "eval/part_library.hpp"
#include "pose/ray_pose.hpp"
#include "train/icosphere.hpp"

namespace binpick::peers {
namespace {

constexpr std::size_t kCandidatesMax = 120;  // that are aligned and checked
constexpr double kUnitsPerMm = 10;           // of LINEMOD's depth images

// Rotations that show the part from all around.
std::vector<Mat3> views(int subdivisions) {
  const train::Icosphere sphere = train::make_icosphere(subdivisions);
  const auto count = static_cast<std::size_t>(sphere.counts.back());
  std::vector<Mat3> rotations;
  for (std::size_t i = 0; i < count; ++i)
    rotations.push_back(rotation_between(sphere.vertices[i], -Vec3::UnitZ()));
  return rotations;
}

class Linemod {
 public:
  Linemod(PoseRefiner& refiner, const CameraIntrinsics& camera, const app::DistanceRange& range)
      : camera_(camera),
        detector_({cv::linemod::ColorGradient::create(10, 63, 55),
                   cv::linemod::DepthNormal::create(20000, 100, 63, 2)},
                  {5, 8}) {
    for (const double share : {0.25, 0.75}) {
      const double distance_mm = range.min_mm + share * (range.max_mm - range.min_mm);
      for (const Mat3& view : views(3)) {
        for (int roll = 0; roll < 20; ++roll)
          add(refiner, rotation_from_vector({0, 0, roll * 18 * kDegree}) * view, distance_mm);
      }
    }
  }

  std::vector<Pose> match(const drivers::LoadedFrame& frame) const {
    const cv::Rect region = region_of(frame);
    std::vector<cv::linemod::Match> matches;
    detector_.match(images_of(frame, region), 75, matches);
    std::vector<Pose> poses;
    std::vector<Vec2> middles;
    for (const cv::linemod::Match& m : matches) {
      const Template& t = templates_[static_cast<std::size_t>(m.template_id)];
      const Vec2 middle(m.x + t.middle.x(), m.y + t.middle.y());
      // Some templates a place: the best is not always the right one.
      const auto near = std::count_if(middles.begin(), middles.end(), [&](const Vec2& other) {
        return (other - middle).norm() < 10;
      });
      if (near >= 3) continue;
      middles.push_back(middle);
      const Vec3 ray = camera_.ray(middle.x() + region.x, middle.y() + region.y);
      poses.push_back(on_ray(t.R, ray, t.distance_mm));
      if (poses.size() == kCandidatesMax) break;
    }
    return poses;
  }

 private:
  struct Template {
    Mat3 R;
    double distance_mm;
    Vec2 middle;  // of the part, from the corner of the features
  };

  void add(PoseRefiner& refiner, const Mat3& R, double distance_mm) {
    const int side =
        static_cast<int>(1.2 * refiner.diameter_mm() * camera_.fx / distance_mm) / 16 * 16 + 32;
    CameraIntrinsics camera = camera_;
    camera.width = camera.height = side;
    camera.cx = camera.cy = side / 2;
    const train::RenderedView& view = refiner.render(camera, {R, {0, 0, distance_mm}});
    cv::Mat gray(side, side, CV_8U, cv::Scalar(0)), depth, color;
    for (std::size_t i = 0; i < view.depth_mm.size(); ++i) {
      if (view.depth_mm[i] > 0)
        gray.data[i] = cv::saturate_cast<std::uint8_t>(40 - 200 * view.normal_cam[i].z());
    }
    cv::merge(std::vector<cv::Mat>(3, gray), color);
    cv::Mat(view.depth_mm).reshape(1, side).convertTo(depth, CV_16U, kUnitsPerMm);
    cv::Rect box;
    if (detector_.addTemplate({color, depth}, "part", depth > 0, &box) < 0) return;
    templates_.push_back({R, distance_mm, Vec2(camera.cx - box.x, camera.cy - box.y)});
  }

  // Sides are multiples of what both pyramid levels need: of 5 and 16 px. With other widths
  // OpenCV 4.6 reads rows of the upper level as if they were aligned.
  static cv::Rect region_of(const drivers::LoadedFrame& frame) {
    constexpr int kMultiple = 160;
    const int width = (frame.roi.width + kMultiple - 1) / kMultiple * kMultiple,
              height = (frame.roi.height + kMultiple - 1) / kMultiple * kMultiple;
    return {std::clamp(frame.roi.x, 0, frame.camera.width - width),
            std::clamp(frame.roi.y, 0, frame.camera.height - height), width, height};
  }

  static std::vector<cv::Mat> images_of(const drivers::LoadedFrame& frame, const cv::Rect& region) {
    const cv::Mat gray = cv::Mat(frame.intensity).reshape(1, frame.camera.height),
                  mm = cv::Mat(frame.depth_mm).reshape(1, frame.camera.height);
    cv::Mat color, depth;
    cv::merge(std::vector<cv::Mat>(3, gray(region)), color);
    mm(region).convertTo(depth, CV_16U, kUnitsPerMm);
    return {color, depth};
  }

  CameraIntrinsics camera_;
  cv::linemod::Detector detector_;
  std::vector<Template> templates_;
};

class Ppf {
 public:
  Ppf(PoseRefiner& refiner, const CameraIntrinsics& camera, const app::DistanceRange& range)
      : detector_(0.08, 0.08) {
    // Which poses are one: the defaults are shares, and are taken for mm.
    detector_.setSearchParams(0.1 * refiner.diameter_mm(), 15 * kDegree);
    CameraIntrinsics view_camera = camera;
    view_camera.width = view_camera.height = 640;
    view_camera.cx = view_camera.cy = 320;
    Cloud model;
    for (const Mat3& R : views(2)) {
      const Pose T{R, {0, 0, range.max_mm}};
      for (const cv::Vec6f& p : cloud_of(refiner.render(view_camera, T), view_camera, 3)) {
        const Vec3 x = T.inverse() * Vec3(p[0], p[1], p[2]),
                   n = R.transpose() * Vec3(p[3], p[4], p[5]);
        model.emplace_back(x.x(), x.y(), x.z(), n.x(), n.y(), n.z());
      }
    }
    detector_.trainModel(matrix_of(model));
  }

  std::vector<Pose> match(const Cloud& scene) {
    std::vector<cv::ppf_match_3d::Pose3DPtr> results;
    detector_.match(matrix_of(scene), results, 1.0 / 5, 0.015);
    std::vector<Pose> poses;
    for (const auto& result : results) {
      if (poses.size() == kCandidatesMax) break;
      Pose T;
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) T.R(r, c) = result->pose(r, c);
        T.t_mm[r] = result->pose(r, 3);
      }
      if (T.t_mm.z() > 0) poses.push_back(T);
    }
    return poses;
  }

 private:
  cv::ppf_match_3d::PPF3DDetector detector_;
};

struct TrainedPeers {
  TrainedPeers(const train::Mesh& mesh, const drivers::LoadedFrame& frame)
      : refiner(mesh, frame.camera),
        linemod(refiner, frame.camera, app::measured_range(frame.view()).value()),
        ppf(refiner, frame.camera, app::measured_range(frame.view()).value()) {}
  PoseRefiner refiner;
  Linemod linemod;
  Ppf ppf;
};

class Run {
 public:
  Run(const std::string& name, const std::filesystem::path& out)
      : name_(name), writer_((out / (name + ".csv")).string()) {}

  template <class Match>
  void search(const app::WantedFrame& wanted, const drivers::LoadedFrame& frame,
              PoseRefiner& refiner, const Match& match) {
    const std::int64_t begin_ns = app::monotonic_ns();
    const Cloud scene = cloud_of(frame, 2);
    const std::vector<Pose> poses = match(scene);
    const std::int64_t matched_ns = app::monotonic_ns();
    const std::vector<ScoredPose> refined = refiner.refine(poses, frame, scene);
    const double total_s = static_cast<double>(app::monotonic_ns() - begin_ns) * 1e-9;
    for (const ScoredPose& pose : refined)
      writer_.add({wanted.id, *wanted.objects.begin(), pose.score, pose.T_cam_obj, total_s});
    times_["match_ms"].push_back(static_cast<double>(matched_ns - begin_ns) * 1e-6);
    times_["total_ms"].push_back(total_s * 1e3);
  }
  void finish(nlohmann::json& out) {
    writer_.close();
    out[name_] = times_;
  }

 private:
  std::string name_;
  app::BopResultsWriter writer_;
  nlohmann::json times_;
};

void run(const std::string& root, const std::filesystem::path& out) {
  cv::setNumThreads(1);
  const drivers::BopDataset dataset(root, "test");
  const app::EvalPlan plan = app::make_eval_plan(dataset, {});
  const app::PartLibrary parts = app::load_parts(dataset, plan.objects());
  Run linemod_run("linemod", out), ppf_run("ppf", out);
  for (const auto& [obj_id, part] : parts) {
    std::optional<TrainedPeers> peers;
    for (const app::WantedFrame& wanted : plan.frames) {
      if (wanted.objects != std::set<int>{obj_id}) continue;
      const drivers::LoadedFrame frame =
          dataset.load_frame(plan.scenes.at(wanted.id.scene_id), wanted.id.im_id);
      if (!peers) peers.emplace(part.imported.mesh, frame);
      linemod_run.search(wanted, frame, peers->refiner,
                         [&](const Cloud&) { return peers->linemod.match(frame); });
      ppf_run.search(wanted, frame, peers->refiner,
                     [&](const Cloud& scene) { return peers->ppf.match(scene); });
      std::cerr << "peers: frame " << drivers::frame_name(wanted.id) << std::endl;
    }
  }
  nlohmann::json times;
  linemod_run.finish(times);
  ppf_run.finish(times);
  std::ofstream(out / "peers.json") << times.dump();
}

}  // namespace
}  // namespace binpick::peers

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: peers_bench DATASET OUT\n";
    return 2;
  }
  try {
    binpick::peers::run(argv[1], argv[2]);
  } catch (const std::exception& e) {
    std::cerr << "peers_bench: " << e.what() << '\n';
    return 1;
  }
}
