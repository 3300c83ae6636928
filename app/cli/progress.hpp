// How far a long job is, on stderr: a bar that is redrawn where a person watches a terminal, a line
// each ten percent where the output goes to a file. Thread: one at a time.
#pragma once

#include <chrono>
#include <memory>
#include <string>

namespace binpick::app {

class Progress {
 public:
  explicit Progress(std::string label);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void update(double share);  // 0..1
  double elapsed_s() const;

 private:
  void draw_bar(double share);
  void print_line(double share);

  std::string label_;
  std::chrono::steady_clock::time_point begin_;
  bool terminal_;
  bool bar_shown_ = false;
  int percent_shown_ = -1;
};

// One bar after the other, for jobs of several steps.
class StepProgress {
 public:
  void update(const std::string& step, double share);
  void finish();  // the bar, if there is one: before other output

 private:
  std::string step_;
  std::unique_ptr<Progress> progress_;
};

}  // namespace binpick::app
