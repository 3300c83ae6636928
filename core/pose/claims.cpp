#include "pose/claims.hpp"

#include "binpick/base/arena_plan.hpp"

namespace binpick {

std::size_t Claims::footprint(int width_max, int height_max, int owners_max, int thread_count) {
  ArenaPlan plan;
  plan.take<Hypothesis*>(static_cast<std::size_t>(owners_max));
  return plan.bytes + SceneOwnership::footprint(width_max, height_max, owners_max, thread_count);
}

Claims::Claims(int width_max, int height_max, int owners_max, int thread_count, Arena& arena)
    : ownership_(width_max, height_max, owners_max, thread_count, arena),
      owners_(arena.take<Hypothesis*>(static_cast<std::size_t>(owners_max))) {}

void Claims::clear(const Scene& scene) {
  ownership_.clear(scene);
  owner_count_ = 0;
}

Hypothesis* Claims::owner_of(const PoseContext& context, const Hypothesis& h, int thread) const {
  const SceneOwnership::Owned owned =
      ownership_.owned(context.models[h.candidate.model], context.scene, h.T_cam_centre, thread);
  return owned.share > kOwnedShareMax ? owners_[static_cast<std::size_t>(owned.owner)] : nullptr;
}

bool Claims::add(const PoseContext& context, Hypothesis& h) {
  if (owner_count_ == owners_.size()) return false;
  ownership_.claim(context.models[h.candidate.model], context.scene, h.T_cam_centre,
                   static_cast<int>(owner_count_));
  owners_[owner_count_++] = &h;
  return true;
}

}  // namespace binpick
