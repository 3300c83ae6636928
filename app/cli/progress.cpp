#include "cli/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace binpick::app {
namespace {

constexpr int kBarWidth = 40;
constexpr int kLineStepPercent = 10;

}  // namespace

Progress::Progress(std::string label)
    : label_(std::move(label)),
      begin_(std::chrono::steady_clock::now()),
      terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (bar_shown_) std::fprintf(stderr, "\n");
}

double Progress::elapsed_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

void Progress::update(double share) {
  share = std::clamp(share, 0.0, 1.0);
  if (terminal_) {
    draw_bar(share);
  } else {
    print_line(share);
  }
}

void Progress::draw_bar(double share) {
  const int percent = static_cast<int>(100 * share);
  if (percent == percent_shown_) return;
  percent_shown_ = percent;
  bar_shown_ = true;
  const std::string bar(static_cast<std::size_t>(share * kBarWidth), '#');
  std::fprintf(stderr, "\r%s [%-*s] %3d %%", label_.c_str(), kBarWidth, bar.c_str(), percent);
  if (share > 0.02) {
    std::fprintf(stderr, "  %3.0f s left ", elapsed_s() * (1 - share) / share);
  }
  std::fflush(stderr);
}

void Progress::print_line(double share) {
  const int percent = static_cast<int>(100 * share) / kLineStepPercent * kLineStepPercent;
  if (percent == percent_shown_) return;
  percent_shown_ = percent;
  std::fprintf(stderr, "%s %d %% (%.0f s)\n", label_.c_str(), percent, elapsed_s());
}

void StepProgress::update(const std::string& step, double share) {
  if (!progress_ || step_ != step) {
    finish();
    progress_ = std::make_unique<Progress>(step);
    step_ = step;
  }
  progress_->update(share);
  if (share >= 1) finish();
}

void StepProgress::finish() {
  progress_.reset();
}

}  // namespace binpick::app
