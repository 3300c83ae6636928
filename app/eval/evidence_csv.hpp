// What each detection's score is made of, one line a detection, for fitting the score's weights:
// scene_id,im_id,obj_id,score,R,t, then one column for each ScoreTerm.
#pragma once

#include <fstream>
#include <string>

#include "binpick/report/detection.hpp"
#include "eval/bop_results.hpp"

namespace binpick::app {

class EvidenceWriter {
 public:
  // Throws DatasetError naming the file.
  explicit EvidenceWriter(const std::string& path);
  void add(const ResultRow& row, const ScoreTerms& terms);
  void close();  // flushes, and throws if anything was not written

 private:
  std::string path_;
  std::ofstream file_;
};

}  // namespace binpick::app
