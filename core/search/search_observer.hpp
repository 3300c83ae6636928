// Looks on while a search runs and tells nothing back. Only a diagnosis has one: it is asked for
// between steps, never for a candidate.
#pragma once

#include <span>

#include "search/candidate.hpp"

namespace binpick {

struct SearchContext;

class SearchObserver {
 public:
  // The candidates of one model at tree depth `depth`: as the scan or the descent left them
  // (entries without a score are unused), and as selected from those, best first.
  virtual void candidates(const SearchContext& context, int model_index, int depth, bool selected,
                          std::span<const Candidate> candidates) = 0;

 protected:
  ~SearchObserver() = default;
};

}  // namespace binpick
