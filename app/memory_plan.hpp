// What the daemon takes, before it takes it: a table of named lines from each part's own
// footprint(). What is in the arena is exact; what parts take from the heap, once at start, is
// listed beside it. Set-up only.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "binpick/frame/frame_pool.hpp"
#include "station/recipe_set.hpp"

namespace binpick::app {

struct PlanLine {
  enum class Place { kArena, kHeap, kStack };
  std::string owner, what;
  std::size_t count = 1, bytes_each = 0;
  Place place = Place::kArena;

  std::size_t bytes() const { return count * bytes_each; }
};

struct MemoryPlan {
  std::vector<PlanLine> lines;

  std::size_t arena_bytes() const;
  std::size_t bytes_total() const;
  // As a table for people, a line each and the sum.
  std::string text() const;
};

// Who holds a frame at the same time, one term each.
FramePoolParams frame_pool_params(const Config& config);

// Threads that compute, as configured or one for each processor.
int worker_count(const Config& config);

MemoryPlan make_memory_plan(const Config& config, const RecipeSet& recipes);

// Throws SetupError with the sums where the plan is larger than what the configuration allows or,
// where memory is to be locked and has to be, the system.
void check_memory_plan(const MemoryPlan& plan, const MemoryConfig& config);

// Locks all pages that the process has touched, and each that it comes to touch, if the
// configuration wants it. Returns why nothing is locked though it is wanted; throws SetupError
// instead if it has to be. Empty: all is as wanted.
std::string lock_memory(const MemoryPlan& plan, const MemoryConfig& config);

}  // namespace binpick::app
