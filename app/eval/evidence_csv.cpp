#include "eval/evidence_csv.hpp"

#include <cerrno>
#include <cstring>
#include <limits>

namespace binpick::app {

EvidenceWriter::EvidenceWriter(const std::string& path) : path_(path), file_(path) {
  file_.precision(std::numeric_limits<float>::max_digits10);
  file_ << "scene_id,im_id,obj_id,score,R,t";
  for (int i = 0; i < kScoreTermCount; ++i)
    file_ << ',' << score_term_name(static_cast<ScoreTerm>(i));
  file_ << '\n' << std::flush;
  if (!file_) throw drivers::DatasetError(path + ": cannot be written: " + std::strerror(errno));
}

void EvidenceWriter::add(const ResultRow& row, const ScoreTerms& terms) {
  file_ << row.frame.scene_id << ',' << row.frame.im_id << ',' << row.obj_id << ',' << row.score
        << ',';
  for (int i = 0; i < 9; ++i) file_ << (i == 0 ? "" : " ") << row.T_cam_obj.R(i / 3, i % 3);
  for (int i = 0; i < 3; ++i) file_ << (i == 0 ? ',' : ' ') << row.T_cam_obj.t_mm[i];
  for (const double term : terms) file_ << ',' << term;
  file_ << '\n';
}

void EvidenceWriter::close() {
  file_.close();
  if (!file_) throw drivers::DatasetError(path_ + ": could not be written whole");
}

}  // namespace binpick::app
