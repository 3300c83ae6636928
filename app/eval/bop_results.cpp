#include "eval/bop_results.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

namespace binpick::app {
namespace {

using drivers::DatasetError;

constexpr const char* kHeader = "scene_id,im_id,obj_id,score,R,t,time";

std::string shortest(double value) {
  char text[32];
  const auto result = std::to_chars(text, text + sizeof text, value);
  return {text, result.ptr};
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    parts.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

template <class T>
bool parse(std::string_view text, T& value) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

bool parse_numbers(std::string_view text, std::size_t count, double* values) {
  std::size_t found = 0;
  for (const std::string_view word : split(trimmed(text), ' ')) {
    if (word.empty()) continue;
    if (found == count || !parse(word, values[found])) return false;
    ++found;
  }
  return found == count;
}

// False with the name of the column that cannot be read.
bool parse_row(const std::vector<std::string_view>& cells, ResultRow& row, const char*& column) {
  double R[9];
  column = "scene_id";
  if (!parse(cells[0], row.frame.scene_id)) return false;
  column = "im_id";
  if (!parse(cells[1], row.frame.im_id)) return false;
  column = "obj_id";
  if (!parse(cells[2], row.obj_id)) return false;
  column = "score";
  if (!parse(cells[3], row.score) || !std::isfinite(row.score)) return false;
  column = "R";
  if (!parse_numbers(cells[4], 9, R)) return false;
  row.T_cam_obj.R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R);
  column = "t";
  if (!parse_numbers(cells[5], 3, row.T_cam_obj.t_mm.data())) return false;
  column = "time";
  return cells.size() < 7 || trimmed(cells[6]).empty() || parse(cells[6], row.time_s);
}

}  // namespace

BopResultsWriter::BopResultsWriter(const std::string& path) : path_(path), file_(path) {
  file_ << kHeader << '\n' << std::flush;
  if (!file_) throw DatasetError(path + ": cannot be written: " + std::strerror(errno));
}

void BopResultsWriter::add(const ResultRow& row) {
  file_ << row.frame.scene_id << ',' << row.frame.im_id << ',' << row.obj_id << ','
        << shortest(row.score) << ',';
  for (int i = 0; i < 9; ++i)
    file_ << (i == 0 ? "" : " ") << shortest(row.T_cam_obj.R(i / 3, i % 3));
  for (int i = 0; i < 3; ++i) file_ << (i == 0 ? ',' : ' ') << shortest(row.T_cam_obj.t_mm[i]);
  file_ << ',' << shortest(row.time_s) << '\n';
}

void BopResultsWriter::close() {
  file_.close();
  if (!file_) throw DatasetError(path_ + ": could not be written whole");
}

std::vector<ResultRow> read_bop_results(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw DatasetError(path + ": cannot be opened");
  std::vector<ResultRow> rows;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (trimmed(line).empty() || (number == 1 && trimmed(line).starts_with("scene_id"))) continue;
    const std::string place = path + ": line " + std::to_string(number);
    const std::vector<std::string_view> cells = split(line, ',');
    if (cells.size() != 6 && cells.size() != 7) {
      throw DatasetError(place + ": has " + std::to_string(cells.size()) +
                         " columns; expected are " + kHeader);
    }
    ResultRow row;
    const char* column = "";
    if (!parse_row(cells, row, column))
      throw DatasetError(place + ": column " + column + " cannot be read");
    if (row.T_cam_obj.R.allFinite() && row.T_cam_obj.t_mm.allFinite()) rows.push_back(row);
  }
  return rows;
}

std::map<drivers::FrameId, double> times_of_frames(const std::vector<ResultRow>& rows) {
  std::map<drivers::FrameId, double> times;
  for (const ResultRow& row : rows) {
    if (!(row.time_s >= 0)) continue;
    const auto [it, first] = times.emplace(row.frame, row.time_s);
    it->second = std::max(it->second, row.time_s);
  }
  return times;
}

}  // namespace binpick::app
