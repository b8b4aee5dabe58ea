#include "drivers/datasets/reading/lists/image_pairs.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>

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

/// The time in a name: "1305031452.791720" in seconds, "0000012-000000366736" in microseconds.
std::optional<int64_t> stamp_in_name(const fs::path& file) {
  constexpr size_t kRedwoodDigits = 12;
  constexpr int64_t kNsPerMicrosecond = 1000;
  const std::string stem = file.stem().string();
  const size_t dash = stem.find('-');
  if (dash != std::string::npos && stem.size() - dash - 1 == kRedwoodDigits) {
    const auto microseconds = parse_number(std::string_view(stem).substr(dash + 1));
    if (microseconds) return static_cast<int64_t>(*microseconds) * kNsPerMicrosecond;
  }
  const bool decimal =
      stem.find('.') != std::string::npos && stem.find_first_not_of("0123456789.") == std::string::npos;
  return decimal ? parse_stamp_ns(stem) : std::nullopt;
}

/// Nothing unless all names have increasing times.
std::optional<std::vector<int64_t>> stamps_in_names(const std::vector<fs::path>& files) {
  std::vector<int64_t> stamps_ns;
  for (const fs::path& file : files) {
    const auto stamp_ns = stamp_in_name(file);
    if (!stamp_ns || (!stamps_ns.empty() && *stamp_ns <= stamps_ns.back())) return std::nullopt;
    stamps_ns.push_back(*stamp_ns);
  }
  return stamps_ns;
}

/// The last digits of a name, by which "color_0012" and "12_depth" belong together.
std::string last_number(const fs::path& file) {
  constexpr const char* kDigits = "0123456789";
  const std::string stem = file.stem().string();
  const size_t last = stem.find_last_of(kDigits);
  if (last == std::string::npos) return "0";
  const size_t before = stem.find_last_not_of(kDigits, last);
  std::string digits = stem.substr(before == std::string::npos ? 0 : before + 1);
  digits.resize(std::min(digits.find_first_not_of(kDigits), digits.size()));
  digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size()));
  return digits.empty() ? "0" : digits;
}

void skip_image(const fs::path& image, const char* other, SkippedFrames& skipped) {
  skipped.add(
      {image.filename().string(), fmt::format("{}: no {} image of this number", image.string(), other)});
}

/// Leaves `sequence` as it is if depth images have no different numbers.
void pair_by_name(const std::vector<fs::path>& color, const std::vector<fs::path>& depth,
                  RecordedSequence& sequence) {
  std::map<std::string, fs::path> depth_of;
  for (const fs::path& file : depth) depth_of.emplace(last_number(file), file);
  if (depth_of.size() != depth.size()) return;
  std::vector<fs::path> alone;
  for (const fs::path& file : color) {
    const auto found = depth_of.find(last_number(file));
    if (found == depth_of.end()) {
      alone.push_back(file);
      continue;
    }
    sequence.frames.push_back({0, 0, {file}, {found->second}, {}, 0});
    depth_of.erase(found);
  }
  for (const fs::path& file : alone) skip_image(file, "depth", sequence.skipped);
  for (const fs::path& file : depth) {
    if (depth_of.contains(last_number(file))) skip_image(file, "colour", sequence.skipped);
  }
}

/// Some folders have a picture of depth beside each array: "0.png" and "0.npy". The arrays are kept.
std::vector<fs::path> without_pictures_of_arrays(std::vector<fs::path> depth) {
  std::set<fs::path> arrays;
  for (const fs::path& file : depth) {
    if (file.extension() == ".npy" || file.extension() == ".npz") arrays.insert(file.stem());
  }
  std::erase_if(depth, [&](const fs::path& file) {
    return file.extension() == ".png" && arrays.contains(file.stem());
  });
  return depth;
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

void pair_folders(const fs::path& color_folder, const fs::path& depth_folder, double fps,
                  RecordedSequence& sequence) {
  const auto depth = without_pictures_of_arrays(images_in(depth_folder, is_depth_name));
  pair_images(images_in(color_folder, is_color_name), depth, fps, sequence);
}

void pair_images(const std::vector<fs::path>& color, const std::vector<fs::path>& depth, double fps,
                 RecordedSequence& sequence) {
  const auto color_ns = stamps_in_names(color), depth_ns = stamps_in_names(depth);
  if (color_ns && depth_ns) sequence.frames = pair_by_time(*color_ns, color, *depth_ns, depth);
  sequence.stamps_measured = !sequence.frames.empty();
  if (sequence.stamps_measured) return;
  pair_by_name(color, depth, sequence);
  const bool nearly_none = sequence.frames.size() * 2 < std::min(color.size(), depth.size());
  if (nearly_none && color.size() == depth.size()) {
    sequence.frames.clear();
    sequence.skipped = {};
    for (size_t i = 0; i < color.size(); ++i)
      sequence.frames.push_back({0, 0, {color[i]}, {depth[i]}, {}, 0});
  }
  if (sequence.frames.empty()) {
    const auto& some = color.empty() ? depth : color;
    throw InputError(fmt::format(
        "{}: {} colour images and {} depth images{}, but neither their names nor their number tell which "
        "belong together; write associations.txt",
        some.empty() ? "images" : some.front().parent_path().string(), color.size(), depth.size(),
        color.empty() || depth.empty() || color.front().parent_path() == depth.front().parent_path()
            ? ""
            : " in " + depth.front().parent_path().string()));
  }
  stamp_by_rate(sequence.frames, fps);
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
