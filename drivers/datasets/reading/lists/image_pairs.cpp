#include "drivers/datasets/reading/lists/image_pairs.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "drivers/datasets/folder_contents.hpp"
#include "kinloop/core/association.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::optional<uint64_t> parse_number(std::string_view digits) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty() || error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const bool hidden = entry->path().filename().string().starts_with('.');  // "._0.png" of macOS archives
    if (!hidden) files.push_back(entry->path());
  }
  if (error) throw InputError(fmt::format("{}: cannot be read: {}", folder.string(), error.message()));
  return files;
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    const auto number_at = [](std::string_view text, size_t& at) {
      while (at < text.size() && text[at] == '0') ++at;
      const size_t begin = at;
      while (at < text.size() && is_digit(text[at])) ++at;
      return text.substr(begin, at - begin);
    };
    const std::string_view x = number_at(a, i), y = number_at(b, j);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
  }
  return a.size() - i < b.size() - j;
}

std::optional<uint64_t> numbered_name(const fs::path& file, std::string_view beginning,
                                      std::string_view end) {
  const std::string name = file.filename().string();
  const size_t around = beginning.size() + end.size();
  if (name.size() <= around || !name.starts_with(beginning) || !name.ends_with(end)) return std::nullopt;
  return parse_number(std::string_view(name).substr(beginning.size(), name.size() - around));
}

std::vector<NumberedFile> numbered_files(const fs::path& folder, std::string_view beginning,
                                         std::string_view end) {
  std::vector<NumberedFile> found;
  for (const fs::path& file : files_in(folder)) {
    if (const auto number = numbered_name(file, beginning, end)) found.push_back({*number, file});
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::tie(a.number, a.path) < std::tie(b.number, b.path);
  });
  return found;
}

std::vector<fs::path> images_in(const fs::path& folder, bool (*is_image)(const fs::path& file)) {
  std::vector<fs::path> images;
  for (const fs::path& file : files_in(folder)) {
    if (is_image(file)) images.push_back(file);
  }
  std::sort(images.begin(), images.end(), [](const fs::path& a, const fs::path& b) {
    const std::string x = a.filename().string(), y = b.filename().string();
    if (natural_less(x, y) != natural_less(y, x)) return natural_less(x, y);
    return x < y;
  });
  return images;
}

std::vector<RecordedFrame> pair_by_number(const std::vector<NumberedFile>& color,
                                          const std::vector<NumberedFile>& depth, double fps) {
  constexpr uint64_t kMaxNumber = 10'000'000;  // beyond it numbers are not those of frames
  std::vector<RecordedFrame> frames;
  auto d = depth.begin();
  std::optional<uint64_t> previous;
  for (const NumberedFile& c : color) {
    while (d != depth.end() && d->number < c.number) ++d;
    if (d == depth.end()) break;
    if (d->number != c.number || previous == c.number) continue;
    previous = c.number;
    const int64_t stamp_ns = checked_stamp(static_cast<double>(std::min(c.number, kMaxNumber)) / fps, c.path);
    frames.push_back({stamp_ns, stamp_ns, {c.path}, {d->path}, {}, 0});
  }
  if (frames.empty()) {
    const auto& some = color.empty() ? depth : color;
    throw InputError(fmt::format("{}: {} colour and {} depth images, none of the same number; copy both",
                                 some.empty() ? "images" : some.front().path.parent_path().string(),
                                 color.size(), depth.size()));
  }
  if (*previous > kMaxNumber) stamp_by_rate(frames, fps);
  return frames;
}

std::vector<RecordedFrame> pair_by_time(const std::vector<int64_t>& color_ns,
                                        const std::vector<fs::path>& color,
                                        const std::vector<int64_t>& depth_ns,
                                        const std::vector<fs::path>& depth) {
  std::vector<RecordedFrame> frames;
  for (const auto& [c, d] : associate_stamps(color_ns, depth_ns))
    frames.push_back({color_ns[c], depth_ns[d], {color[c]}, {depth[d]}, {}, 0});
  return frames;
}

void stamp_by_rate(std::vector<RecordedFrame>& frames, double fps) {
  for (size_t i = 0; i < frames.size(); ++i)
    frames[i].stamp_ns = frames[i].depth_stamp_ns = to_ns(static_cast<double>(i) / fps);
}

double median_rate_hz(const std::vector<RecordedFrame>& frames, double otherwise) {
  std::vector<double> intervals_s;
  for (size_t i = 1; i < frames.size(); ++i)
    intervals_s.push_back(to_seconds(frames[i].stamp_ns - frames[i - 1].stamp_ns));
  const double interval_s = median(intervals_s);
  return interval_s > 0 ? 1 / interval_s : otherwise;
}

void keep_increasing(RecordedSequence& sequence) {
  auto& frames = sequence.frames;
  std::stable_sort(frames.begin(), frames.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  std::vector<RecordedFrame> kept;
  for (RecordedFrame& frame : frames) {
    if (kept.empty() || frame.stamp_ns > kept.back().stamp_ns) {
      kept.push_back(std::move(frame));
      continue;
    }
    const std::string name = frame.color.file.filename().string();
    sequence.skipped.add({name, fmt::format("{}: its time repeats", frame.color.file.string())});
  }
  frames = std::move(kept);
  sequence.ground_truth = sorted_by_time(std::move(sequence.ground_truth));
}

Trajectory sorted_by_time(Trajectory trajectory) {
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  const auto repeats = [](const auto& a, const auto& b) { return a.stamp_ns == b.stamp_ns; };
  trajectory.erase(std::unique(trajectory.begin(), trajectory.end(), repeats), trajectory.end());
  return trajectory;
}

int64_t checked_stamp(double seconds, const fs::path& file) {
  if (!(std::abs(seconds) <= to_seconds(kMaxStampNs)))
    throw InputError(fmt::format("{}: {} is not a time in seconds", file.string(), seconds));
  return to_ns(seconds);
}

Trajectory truth_of(const std::vector<RecordedFrame>& frames,
                    const std::function<std::optional<SE3>(const RecordedFrame&, size_t)>& pose_of_frame) {
  Trajectory truth;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (const auto T_world_camera = pose_of_frame(frames[i], i))
      truth.push_back({frames[i].stamp_ns, *T_world_camera});
  }
  return truth;
}

}  // namespace kinloop
