#include "apps/shared/terminal/progress_bar.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <mutex>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "kinloop/core/stopwatch.hpp"

namespace kinloop {
namespace {

constexpr double kRedrawS = 0.1;        ///< faster than anyone can read
constexpr double kFirstLineS = 1;       ///< without a terminal: shorter stages print nothing
constexpr double kLineS = 5;            ///< interval of further lines
constexpr size_t kDefaultColumns = 80;  ///< if the terminal does not report it
constexpr size_t kNoLimit = 1000;       ///< a file has no width
constexpr const char* kClearRest = "\033[K";

size_t terminal_columns() {
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : kDefaultColumns;
}

/// Without an exception if the terminal is gone: the run goes on.
void put(const std::string& text) {
  std::fputs(text.c_str(), stderr);
}

/// "17 s", "3 min 05 s", "2 h 10 min".
std::string duration_text(double seconds) {
  constexpr long kMinute = 60, kHour = 3600;
  const long s = std::lround(std::ceil(seconds));
  if (s < kMinute) return fmt::format("{} s", s);
  if (s < kHour) return fmt::format("{} min {:02} s", s / kMinute, s % kMinute);
  return fmt::format("{} h {:02} min", s / kHour, s % kHour / kMinute);
}

double share_done(const ProgressReport& now) {
  return std::min(1.0, static_cast<double>(now.done) / static_cast<double>(now.total));
}

/// 0 while it is unreliable.
double rate_of(const ProgressReport& now, const StageTime& stage) {
  constexpr double kMinTimeS = 0.5;
  const auto done = static_cast<double>(now.done - std::min(now.done, stage.done_at_start));
  return stage.elapsed_s >= kMinTimeS ? done / stage.elapsed_s : 0;
}

std::string time_text(const ProgressReport& now, const StageTime& stage, double per_second) {
  if (now.done >= now.total) return fmt::format("   {} total", duration_text(stage.elapsed_s));
  if (!(per_second > 0)) return "";
  return fmt::format("   {} left", duration_text(static_cast<double>(now.total - now.done) / per_second));
}

/// Of at most `width` columns with its brackets; empty if that is too short.
std::string bar_text(double share, size_t width) {
  constexpr size_t kLongest = 30, kShortest = 3, kBrackets = 2;
  if (width < kShortest + kBrackets) return "";
  const size_t cells = std::min(kLongest, width - kBrackets);
  const auto full = static_cast<size_t>(share * static_cast<double>(cells));
  std::string bar(full, '=');
  if (full < cells) bar += '>';
  bar.resize(cells, ' ');
  return '[' + bar + ']';
}

/// Redraws its line, and starts a new one for each stage; without a terminal, prints a line now and then.
class Bar {
 public:
  explicit Bar(bool terminal) : terminal_(terminal) {}
  ~Bar() { end_line(); }
  Bar(const Bar&) = delete;
  Bar& operator=(const Bar&) = delete;

  void draw(const ProgressReport& now) {
    const std::lock_guard lock(mutex_);
    const bool finished = now.total > 0 && now.done >= now.total;
    if (now.stage != stage_ || (finished_ && !finished)) begin_stage(now);
    if (finished_) return;
    finished_ = finished;
    const StageTime time{stage_time_.wall_s(), done_at_start_};
    if (terminal_) {
      draw_over(now, time);
    } else {
      write_line(now, time);
    }
  }

 private:
  void begin_stage(const ProgressReport& now) {
    end_line();
    stage_ = now.stage;
    stage_time_ = Stopwatch();
    done_at_start_ = now.done;
    last_drawn_s_ = terminal_ ? -kRedrawS : kFirstLineS - kLineS;
    lines_ = 0;
    finished_ = false;
  }

  void draw_over(const ProgressReport& now, const StageTime& time) {
    if (time.elapsed_s - last_drawn_s_ < kRedrawS && !finished_) return;
    last_drawn_s_ = time.elapsed_s;
    // One column is left free: some terminals wrap when the last one is written.
    put(fmt::format("\r{}{}", progress_line(now, time, terminal_columns() - 1), kClearRest));
    std::fflush(stderr);
    line_open_ = true;
    if (finished_) end_line();  // other output may follow
  }

  /// Prints the end of a stage if its progress was printed.
  void write_line(const ProgressReport& now, const StageTime& time) {
    if (time.elapsed_s - last_drawn_s_ < kLineS && !(finished_ && lines_ > 0)) return;
    last_drawn_s_ = time.elapsed_s;
    ++lines_;
    put(progress_line(now, time, kNoLimit) + "\n");
    std::fflush(stderr);
  }

  void end_line() {
    if (line_open_) put("\n");
    line_open_ = false;
  }

  const bool terminal_;
  std::mutex mutex_;
  std::string stage_;
  Stopwatch stage_time_;
  size_t done_at_start_ = 0, lines_ = 0;
  double last_drawn_s_ = 0;
  bool line_open_ = false, finished_ = false;
};

}  // namespace

Progress make_progress_bar(bool quiet) {
  if (quiet) return {};
  return [bar = std::make_shared<Bar>(isatty(STDERR_FILENO) != 0)](const ProgressReport& now) {
    bar->draw(now);
    return true;
  };
}

std::string progress_line(const ProgressReport& now, const StageTime& stage, size_t width) {
  const double per_second = rate_of(now, stage);
  const std::string rate = per_second > 0 ? fmt::format("{:7.1f}/s", per_second) : std::string(9, ' ');
  const std::string note = now.note.empty() ? "" : "   " + now.note;
  if (now.total == 0) return fmt::format("{:<10} {} {}{}", now.stage, now.done, rate, note).substr(0, width);

  const std::string total = std::to_string(now.total);
  const std::string head = fmt::format("{:<10} ", now.stage);
  const std::string counts = fmt::format("  {:>{}}/{}", now.done, total.size(), total);
  const std::string time = time_text(now, stage, per_second);
  // The bar gives way to the note. It keeps its length while the time has fewer columns than this.
  constexpr size_t kTimeColumns = 13;
  const size_t others =
      head.size() + counts.size() + rate.size() + std::max(time.size(), kTimeColumns) + note.size();
  return (head + bar_text(share_done(now), width > others ? width - others : 0) + counts + rate + time + note)
      .substr(0, width);
}

}  // namespace kinloop
