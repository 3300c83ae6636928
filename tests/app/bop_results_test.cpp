#include "eval/bop_results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "eval/evidence_csv.hpp"
#include "temporary_folder.hpp"

using testing::HasSubstr;

namespace binpick::app {
namespace {

std::vector<ResultRow> read_text(const std::string& text) {
  const TemporaryFolder folder;
  const std::string path = folder.file("results.csv");
  std::ofstream(path) << text;
  return read_bop_results(path);
}

std::string error_of(const std::string& text) {
  try {
    read_text(text);
  } catch (const drivers::DatasetError& e) {
    return e.what();
  }
  return "no error";
}

constexpr const char* kRow = "3,14,2,0.75,1 0 0 0 1 0 0 0 1,1.5 -2 700,0.25";

TEST(BopResults, ReadBackTheSameBits) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1000, 1000);
  std::vector<ResultRow> rows(50);
  for (ResultRow& row : rows) {
    row.frame = {static_cast<int>(random() % 1000), static_cast<int>(random() % 1000)};
    row.obj_id = static_cast<int>(random() % 30);
    row.score = any(random) / 7;
    row.T_cam_obj.R = Mat3::NullaryExpr([&] { return any(random) / 1e9; });
    row.T_cam_obj.t_mm = Vec3::NullaryExpr([&] { return any(random) / 3; });
    row.time_s = std::abs(any(random)) / 1e5;
  }
  const TemporaryFolder folder;
  const std::string path = folder.file("results.csv");
  BopResultsWriter writer(path);
  for (const ResultRow& row : rows) writer.add(row);
  writer.close();

  const std::vector<ResultRow> back = read_bop_results(path);
  ASSERT_EQ(back.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(back[i].frame, rows[i].frame);
    EXPECT_EQ(back[i].obj_id, rows[i].obj_id);
    EXPECT_EQ(back[i].score, rows[i].score);
    EXPECT_EQ(back[i].T_cam_obj.R, rows[i].T_cam_obj.R);
    EXPECT_EQ(back[i].T_cam_obj.t_mm, rows[i].T_cam_obj.t_mm);
    EXPECT_EQ(back[i].time_s, rows[i].time_s);
  }
}

TEST(BopResults, KeepRotationsRowMajor) {
  const auto rows = read_text("1,2,3,0.5,1 2 3 4 5 6 7 8 9,1 2 3,-1\n");
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].T_cam_obj.R(0, 1), 2);
  EXPECT_EQ(rows[0].T_cam_obj.R(2, 0), 7);
}

TEST(BopResults, DoWithoutHeaderTimeAndTidySpacing) {
  const auto rows = read_text(
      "1, 2, 3, 0.5 , 1  0 0 0 1 0 0 0 1 , 1 2 3\r\n\n1,2,3,+0.25,1 0 0 0 1 0 0 0 1,1 2 3,\n");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].time_s, -1);
  EXPECT_EQ(rows[1].score, 0.25);
}

TEST(BopResults, LeaveOutPosesThatAreNotFinite) {
  const auto rows = read_text(std::string(kRow) + "\n1,2,3,0.5,1 0 0 0 nan 0 0 0 1,1 2 3,1\n" +
                              "1,2,3,0.5,1 0 0 0 1 0 0 0 1,1 2 inf,1\n");
  EXPECT_EQ(rows.size(), 1u);
}

TEST(BopResults, NameLineAndColumnOfWhatCannotBeRead) {
  const std::string good = std::string("scene_id,im_id,obj_id,score,R,t,time\n") + kRow + "\n";
  EXPECT_THAT(error_of(good + "1,2,3,0.5,1 0 0 0 1 0 0 0,1 2 3,1\n"),
              HasSubstr("line 3: column R"));
  EXPECT_THAT(error_of(good + "1,2,3,high,1 0 0 0 1 0 0 0 1,1 2 3,1\n"),
              HasSubstr("line 3: column score"));
  EXPECT_THAT(error_of(good + "1,2,3,nan,1 0 0 0 1 0 0 0 1,1 2 3,1\n"), HasSubstr("column score"));
  EXPECT_THAT(error_of(good + "1,2,3,1,1 0 0 0 1 0 0 0 1,1 2 3 4,1\n"), HasSubstr("column t"));
  EXPECT_THAT(error_of(good + "1,2.5,3,1,1 0 0 0 1 0 0 0 1,1 2 3,1\n"), HasSubstr("column im_id"));
  EXPECT_THAT(error_of(good + "1,2,3\n"), HasSubstr("line 3: has 3 columns"));
  EXPECT_THROW(read_bop_results("/nowhere/results.csv"), drivers::DatasetError);
  EXPECT_THROW(BopResultsWriter("/nowhere/results.csv"), drivers::DatasetError);
}

TEST(BopResults, GiveTheLargestTimeOfAFrame) {
  std::vector<ResultRow> rows(4);
  rows[0].frame = rows[1].frame = rows[2].frame = {1, 2};
  rows[0].time_s = 0.1, rows[1].time_s = 0.3, rows[2].time_s = -1;
  rows[3].frame = {1, 3};
  const auto times = times_of_frames(rows);
  EXPECT_EQ(times.size(), 1u);
  EXPECT_EQ(times.at({1, 2}), 0.3);
}

TEST(EvidenceCsv, HasOneColumnForEachTerm) {
  const TemporaryFolder folder;
  const std::string path = folder.file("evidence.csv");
  ResultRow row;
  row.frame = {3, 14};
  row.obj_id = 2;
  row.score = 0.75;
  row.T_cam_obj.t_mm = {1.5, -2, 700};
  ScoreTerms terms{};
  for (std::size_t i = 0; i < terms.size(); ++i) terms[i] = 0.5 * static_cast<double>(i) - 1;
  EvidenceWriter writer(path);
  writer.add(row, terms);
  writer.close();

  std::ifstream file(path);
  std::string header, line, more;
  std::getline(file, header);
  std::getline(file, line);
  EXPECT_EQ(
      header,
      "scene_id,im_id,obj_id,score,R,t,depth_support,contour_support,measured,supported_area,"
      "contradicted,hidden,outline_steps,outline_bare,outline_offset,creases,template,conflicts");
  EXPECT_EQ(line, "3,14,2,0.75,1 0 0 0 1 0 0 0 1,1.5 -2 700,-1,-0.5,0,0.5,1,1.5,2,2.5,3,3.5,4,4.5");
  EXPECT_FALSE(std::getline(file, more));
  EXPECT_THROW(EvidenceWriter("/nowhere/evidence.csv"), drivers::DatasetError);
}

}  // namespace
}  // namespace binpick::app
