// The trained models of one camera group: taken from the cache or trained now. Owns the bytes that
// the models borrow.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "binpick/base/worker_pool.hpp"
#include "binpick/model/object_model.hpp"
#include "eval/distance_range.hpp"
#include "eval/eval_plan.hpp"
#include "eval/model_cache.hpp"
#include "eval/part_library.hpp"
#include "training/part_training.hpp"

namespace binpick::app {

// What a person who waits gets to see; both may be empty.
struct EvalTalk {
  std::function<void(const std::string&)> note;              // a sentence
  std::function<void(const std::string&, double)> progress;  // what, share of it done
};

struct ModelOrigin {
  int obj_id = 0;
  DistanceRange range;
  bool from_cache = false;
  double train_s = 0;
  std::size_t bytes = 0;
};

class ModelSet {
 public:
  ModelSet() = default;
  ModelSet(ModelSet&&) = default;
  ModelSet& operator=(ModelSet&&) = default;

  void add(const ModelOrigin& origin, std::vector<std::uint8_t> bytes, const ObjectModel& model);

  std::span<const ObjectModel> models() const { return models_; }
  const std::vector<ModelOrigin>& origins() const { return origins_; }  // in the order of models()
  int index_of(int obj_id) const;                                       // -1: none

 private:
  std::vector<std::vector<std::uint8_t>> bytes_;
  std::vector<ObjectModel> models_;
  std::vector<ModelOrigin> origins_;
};

struct ModelSetRequest {
  const drivers::BopDataset& dataset;
  const EvalPlan& plan;
  const CameraGroup& group;
  const PartLibrary& parts;
  const ModelCache& cache;
  train::TrainOptions options;  // camera and distances are filled in
  TrialPlan trials;
  std::optional<DistanceRange> range = std::nullopt;  // to train for; nothing: measured
};

// For every object wanted in the group's frames. Where no distance range is given it comes from the
// depth images of up to twenty of those frames; an object none of whose frames has depth then gets
// no model and an entry in `faults`. Throws TrainError, RenderError, std::runtime_error.
ModelSet make_model_set(const ModelSetRequest& request, WorkerPool& pool, const EvalTalk& talk,
                        std::vector<std::string>& faults);

}  // namespace binpick::app
