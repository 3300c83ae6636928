#include "eval/model_set.hpp"

#include <chrono>
#include <optional>
#include <stdexcept>

#include "binpick/check/frame_check.hpp"

namespace binpick::app {
namespace {

using drivers::DatasetError;

constexpr std::size_t kRangeFramesMax = 20;

// What the frames of a group tell about camera and distances; read once, used for every object.
struct GroupMeasurements {
  CameraIntrinsics camera;
  std::map<std::size_t, DistanceRange> ranges;  // by index into the plan's frames
};

// At most kRangeFramesMax of them, spread evenly.
std::vector<std::size_t> spread(const std::vector<std::size_t>& indices) {
  if (indices.size() <= kRangeFramesMax) return indices;
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < kRangeFramesMax; ++i)
    chosen.push_back(indices[i * indices.size() / kRangeFramesMax]);
  return chosen;
}

std::map<int, std::vector<std::size_t>> frames_to_measure(const ModelSetRequest& request) {
  std::map<int, std::vector<std::size_t>> frames;  // by object
  for (const std::size_t i : request.group.frames) {
    for (const int obj_id : request.plan.frames[i].objects) frames[obj_id].push_back(i);
  }
  for (auto& [obj_id, indices] : frames) indices = spread(indices);
  return frames;
}

GroupMeasurements measure(const ModelSetRequest& request,
                          const std::map<int, std::vector<std::size_t>>& frames_of_object) {
  GroupMeasurements found;
  std::set<std::size_t> indices;
  for (const auto& [obj_id, of_object] : frames_of_object)
    indices.insert(of_object.begin(), of_object.end());
  for (const std::size_t i : indices) {
    const drivers::FrameId id = request.plan.frames[i].id;
    try {
      const drivers::LoadedFrame frame =
          request.dataset.load_frame(request.plan.scenes.at(id.scene_id), id.im_id);
      if (found.camera.width == 0) found.camera = frame.camera;
      // What can only be a mistake trains nothing; it is named when its turn to be searched comes.
      if (check_frame(frame.view(), {}).refusal() != nullptr) continue;
      if (const auto range = measured_range(frame.view())) found.ranges[i] = *range;
    } catch (const DatasetError&) {
      // Named when its turn to be looked at comes.
    }
  }
  return found;
}

// What the cache has of a part, if it can be read.
std::optional<std::vector<std::uint8_t>> cached(const ModelCache& cache, int obj_id,
                                                std::uint64_t key, const EvalTalk& talk) {
  auto bytes = cache.find(obj_id, key);
  if (!bytes) return std::nullopt;
  const auto model = ObjectModel::parse(*bytes);
  if (model.ok()) return bytes;
  if (talk.note) {
    talk.note(cache.path_of(obj_id, key) + ": " + error_message(model.error().code) +
              "; training anew");
  }
  return std::nullopt;
}

// The bytes of a model. What the cache has not is made: templates and trials each for itself.
std::vector<std::uint8_t> train_or_find(const Part& part, const train::TrainOptions& options,
                                        const ModelSetRequest& request, WorkerPool& pool,
                                        const EvalTalk& talk, ModelOrigin& origin) {
  const ModelCache& cache = request.cache;
  const int obj_id = origin.obj_id;
  const auto key_of = [&](const TrialPlan& trials) {
    return training_key(part.imported.source_hash, options, trials);
  };
  const std::uint64_t key = key_of(request.trials);
  auto found = cached(cache, obj_id, key, talk);
  origin.from_cache = found.has_value();
  if (found) return std::move(*found);

  const auto begin = std::chrono::steady_clock::now();
  const auto tell = [&](const std::string& step, double share) {
    if (talk.progress) talk.progress(step + " of object " + std::to_string(obj_id), share);
  };
  const std::uint64_t templates_key = key_of(kNoTrials);
  auto templates = key == templates_key ? std::nullopt : cached(cache, obj_id, templates_key, talk);
  if (!templates) {
    templates = train::train_model(part.imported, options, pool,
                                   [&](double share) { tell("training", share); });
    cache.keep(obj_id, templates_key, *templates);
  }
  TrainedPart trained =
      try_part(std::move(*templates), part.imported, options, request.trials, pool, tell);
  if (key != templates_key) cache.keep(obj_id, key, trained.model);
  origin.train_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return std::move(trained.model);
}

}  // namespace

void ModelSet::add(const ModelOrigin& origin, std::vector<std::uint8_t> bytes,
                   const ObjectModel& model) {
  bytes_.push_back(
      std::move(bytes));  // moving keeps the block in place, and with it what the model borrows
  models_.push_back(model);
  origins_.push_back(origin);
}

int ModelSet::index_of(int obj_id) const {
  for (std::size_t i = 0; i < origins_.size(); ++i) {
    if (origins_[i].obj_id == obj_id) return static_cast<int>(i);
  }
  return -1;
}

ModelSet make_model_set(const ModelSetRequest& request, WorkerPool& pool, const EvalTalk& talk,
                        std::vector<std::string>& faults) {
  const auto frames_of_object = frames_to_measure(request);
  const GroupMeasurements measured = measure(request, frames_of_object);
  ModelSet set;
  for (const auto& [obj_id, frames] : frames_of_object) {
    const Part& part = request.parts.at(obj_id);
    std::vector<DistanceRange> ranges;
    for (const std::size_t i : frames) {
      if (measured.ranges.contains(i)) ranges.push_back(measured.ranges.at(i));
    }
    const auto range = request.range
                           ? request.range
                           : training_range(ranges, part.model.diameter_mm, measured.camera);
    if (!range) {
      faults.push_back(
          "object " + std::to_string(obj_id) +
          ": none of its frames has depth inside the region of interest, so there is no distance "
          "to train for: give --distance-mm");
      if (talk.note) talk.note(faults.back());
      continue;
    }
    train::TrainOptions options = request.options;
    options.camera = measured.camera;
    options.distance_min_mm = range->min_mm;
    options.distance_max_mm = range->max_mm;
    ModelOrigin origin{obj_id, *range, false, 0, 0};
    std::vector<std::uint8_t> bytes = train_or_find(part, options, request, pool, talk, origin);
    origin.bytes = bytes.size();
    auto model = ObjectModel::parse(bytes);
    if (!model.ok()) {
      throw std::runtime_error("the model just trained for object " + std::to_string(obj_id) +
                               " is not valid: " + error_message(model.error().code));
    }
    set.add(origin, std::move(bytes), model.value());
  }
  return set;
}

}  // namespace binpick::app
