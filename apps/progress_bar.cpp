#include "apps/progress_bar.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <mutex>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "kinloop/base/stopwatch.hpp"

namespace kinloop {
namespace {

constexpr double kRedrawS = 0.1;        ///< faster than anyone reads
constexpr size_t kDefaultColumns = 80;  ///< where the terminal does not tell
constexpr const char* kClearRest = "\033[K";

size_t terminal_columns() {
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : kDefaultColumns;
}

/// "17 s", "3 min 05 s", "2 h 10 min".
std::string duration_text(double seconds) {
  constexpr long kMinute = 60, kHour = 3600;
  const long s = std::lround(std::ceil(seconds));
  if (s < kMinute) return fmt::format("{} s", s);
  if (s < kHour) return fmt::format("{} min {:02} s", s / kMinute, s % kMinute);
  return fmt::format("{} h {:02} min", s / kHour, s % kHour / kMinute);
}

/// Draws over its own line; a new stage begins a new one.
class Bar {
 public:
  ~Bar() { end_line(); }

  void draw(const ProgressReport& now) {
    const std::lock_guard lock(mutex_);
    if (now.stage != stage_) {
      end_line();
      stage_ = now.stage;
      stage_time_ = Stopwatch();
      last_drawn_s_ = -kRedrawS;
    }
    const double elapsed_s = stage_time_.wall_s();
    const bool finished = now.total > 0 && now.done >= now.total;
    if (elapsed_s - last_drawn_s_ < kRedrawS && !finished) return;
    last_drawn_s_ = elapsed_s;
    // One column is left free: some terminals wrap when the last one is written.
    fmt::print(stderr, "\r{}{}", progress_line(now, elapsed_s, terminal_columns() - 1), kClearRest);
    std::fflush(stderr);
    line_open_ = true;
  }

 private:
  void end_line() {
    if (line_open_) fmt::print(stderr, "\n");
    line_open_ = false;
  }

  std::mutex mutex_;
  std::string stage_;
  Stopwatch stage_time_;
  double last_drawn_s_ = 0;
  bool line_open_ = false;
};

}  // namespace

Progress make_progress_bar(bool quiet) {
  if (quiet || isatty(STDERR_FILENO) == 0) return {};
  return [bar = std::make_shared<Bar>()](const ProgressReport& now) {
    bar->draw(now);
    return true;
  };
}

std::string progress_line(const ProgressReport& now, double elapsed_s, size_t width) {
  const auto done = static_cast<double>(now.done);
  const double per_second = elapsed_s > 0 ? done / elapsed_s : 0;
  const std::string rate = per_second > 0 ? fmt::format("{:7.1f}/s", per_second) : "";
  if (now.total == 0) return fmt::format("{:<10} {} {}", now.stage, now.done, rate).substr(0, width);

  const auto total = static_cast<double>(now.total);
  const double share = std::min(1.0, done / total);
  std::string time;
  if (share >= 1) {
    time = fmt::format("   {} in all", duration_text(elapsed_s));
  } else if (per_second > 0) {
    time = fmt::format("   {} left", duration_text((total - done) / per_second));
  }
  const std::string total_text = std::to_string(now.total);
  const std::string counts = fmt::format("  {:>{}}/{}", now.done, total_text.size(), total_text);
  if (!now.note.empty()) time += "   " + now.note;
  const std::string head = fmt::format("{:<10} ", now.stage);

  constexpr size_t kLongestBar = 30, kShortestBar = 5, kBrackets = 2, kTimeColumns = 20;
  const size_t columns_after = kTimeColumns + (now.note.empty() ? 0 : now.note.size() + 3);
  const size_t others = head.size() + counts.size() + rate.size() + columns_after + kBrackets;
  const size_t cells = width > others ? std::min(kLongestBar, width - others) : 0;
  if (cells < kShortestBar) return (head + counts + rate + time).substr(0, width);
  const auto full = static_cast<size_t>(share * static_cast<double>(cells));
  std::string bar(full, '=');
  if (full < cells) bar += '>';
  bar.resize(cells, ' ');
  return (head + '[' + bar + ']' + counts + rate + time).substr(0, width);
}

}  // namespace kinloop
