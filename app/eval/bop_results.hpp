// The results file that BOP tools exchange: one line per detection,
// scene_id,im_id,obj_id,score,R,t,time with R row-major and t in mm, time in seconds for the whole
// image.
#pragma once

#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "binpick/drivers/bop_dataset.hpp"

namespace binpick::app {

struct ResultRow {
  drivers::FrameId frame;
  int obj_id = 0;
  double score = 0;
  Pose T_cam_obj;
  double time_s = -1;  // -1: unknown
};

// Writes line by line, so that a run that is cut short leaves what it had. Numbers are written with
// as many digits as it takes to read the same bits back. Throws DatasetError naming the file.
class BopResultsWriter {
 public:
  explicit BopResultsWriter(const std::string& path);
  void add(const ResultRow& row);
  void close();  // flushes, and throws if anything was not written

 private:
  std::string path_;
  std::ofstream file_;
};

// Reads such a file, with or without its header line. Rows whose pose is not finite are left out,
// as scoring cannot place them. A malformed row is a DatasetError that names its line.
std::vector<ResultRow> read_bop_results(const std::string& path);

// The time of each frame that any row gives; frames without a detection have none.
std::map<drivers::FrameId, double> times_of_frames(const std::vector<ResultRow>& rows);

}  // namespace binpick::app
