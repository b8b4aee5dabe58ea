#include "drivers/datasets/reading/lists/pair_images.hpp"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "drivers/datasets/folder_contents.hpp"
#include "drivers/datasets/reading/lists/equal_names.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/lists/name_times.hpp"
#include "kinloop/core/association.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/text/lower_case.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

bool is_raw(const fs::path& file) {
  return lower_case(file.extension().string()) == ".raw";
}

/// Some folders have a picture of depth beside each array: "0.png" and "0.npy" or "0.raw". The arrays are
/// kept.
std::vector<fs::path> without_pictures_of_arrays(std::vector<fs::path> depth) {
  std::set<fs::path> arrays;
  for (const fs::path& file : depth) {
    if (file.extension() == ".npy" || file.extension() == ".npz" || is_raw(file)) arrays.insert(file.stem());
  }
  std::erase_if(depth, [&](const fs::path& file) {
    return file.extension() == ".png" && arrays.contains(file.stem());
  });
  return depth;
}

/// The times of both lists of names, if both have times.
struct TimesOfNames {
  FoundTimes color, depth;
};

std::optional<TimesOfNames> times_of_names(const std::vector<fs::path>& color,
                                           const std::vector<fs::path>& depth) {
  auto of_color = times_in_names(color), of_depth = times_in_names(depth);
  if (!of_color && of_depth) of_color = times_in_names(color, of_depth->unit);
  if (!of_depth && of_color) of_depth = times_in_names(depth, of_color->unit);
  if (!of_color || !of_depth) return std::nullopt;
  return TimesOfNames{std::move(*of_color), std::move(*of_depth)};
}

std::string text_of(const TimesOfNames& times) {
  const std::string color = times.color.unit.name, depth = times.depth.unit.name;
  return color == depth ? fmt::format("names are times in {}", color)
                        : fmt::format("names are times, of colour in {}, of depth in {}", color, depth);
}

/// Half the median interval: an image that is farther away belongs to another frame.
int64_t half_interval_ns(std::vector<int64_t> stamps_ns) {
  std::sort(stamps_ns.begin(), stamps_ns.end());
  std::vector<double> intervals_s;
  for (size_t i = 1; i < stamps_ns.size(); ++i)
    intervals_s.push_back(to_seconds(stamps_ns[i] - stamps_ns[i - 1]));
  return intervals_s.empty() ? 0 : to_ns(median(intervals_s) / 2);
}

/// Pairs by time what `pairs` leaves over.
void pair_rest_by_time(const TimesOfNames& times, std::vector<StampPair>& pairs) {
  std::vector<size_t> color, depth;
  std::vector<int64_t> color_ns, depth_ns;
  const auto rest = [](const std::vector<int64_t>& all_ns, const std::set<size_t>& taken,
                       std::vector<size_t>& indices, std::vector<int64_t>& stamps_ns) {
    for (size_t i = 0; i < all_ns.size(); ++i) {
      if (taken.contains(i)) continue;
      indices.push_back(i);
      stamps_ns.push_back(all_ns[i]);
    }
  };
  std::set<size_t> color_taken, depth_taken;
  for (const auto& [c, d] : pairs) color_taken.insert(c), depth_taken.insert(d);
  rest(times.color.stamps_ns, color_taken, color, color_ns);
  rest(times.depth.stamps_ns, depth_taken, depth, depth_ns);
  const int64_t bound_ns = std::min(
      {kMaxAssociationNs, half_interval_ns(times.color.stamps_ns), half_interval_ns(times.depth.stamps_ns)});
  for (const auto& [c, d] : associate_stamps(color_ns, depth_ns, bound_ns))
    pairs.push_back({color[c], depth[d]});
}

[[noreturn]] void reject_pairs(const std::vector<fs::path>& color, const std::vector<fs::path>& depth,
                               const std::optional<TimesOfNames>& times) {
  const auto& some = color.empty() ? depth : color;
  const bool both = !color.empty() && !depth.empty();
  const bool apart = both && color.front().parent_path() != depth.front().parent_path();
  const std::string why = times ? fmt::format("{} and none of the one is within {} s of the other",
                                              text_of(*times), to_seconds(kMaxAssociationNs))
                                : "neither their names nor their number tell which belong together";
  throw InputError(fmt::format("{}: {} colour images and {} depth images{}, but {}; write associations.txt",
                               some.empty() ? "images" : some.front().parent_path().string(), color.size(),
                               depth.size(), apart ? " in " + depth.front().parent_path().string() : "",
                               why));
}

/// Chooses pairs by the first rule that holds, and says which.
std::vector<StampPair> choose_pairs(const std::vector<fs::path>& color, const std::vector<fs::path>& depth,
                                    const std::optional<TimesOfNames>& times, Pairing& pairing) {
  const size_t fewer = std::min(color.size(), depth.size());
  auto equal = pairs_of_equal_names(color, depth);
  if (!equal.empty() && equal.size() * 2 >= fewer) {
    if (times) pair_rest_by_time(*times, equal);
    pairing.rule = "of equal names";
    return equal;
  }
  if (times) {
    auto near = associate_stamps(times->color.stamps_ns, times->depth.stamps_ns);
    pairing.rule = nearest_time_rule();
    if (!near.empty()) return near;
  }
  if (fewer > 0 && color.size() == depth.size()) {
    std::vector<StampPair> in_order;
    for (size_t i = 0; i < color.size(); ++i) in_order.push_back({i, i});
    pairing.rule = "by their order";
    pairing.by_order = true;
    return in_order;
  }
  if (equal.empty()) reject_pairs(color, depth, times);
  pairing.rule = "of equal names";
  return equal;
}

/// Sorts files by their times.
void sort_by_time(std::vector<fs::path>& files, std::vector<int64_t>& stamps_ns) {
  std::vector<std::pair<int64_t, fs::path>> sorted;
  for (size_t i = 0; i < files.size(); ++i) sorted.emplace_back(stamps_ns[i], files[i]);
  std::sort(sorted.begin(), sorted.end());
  for (size_t i = 0; i < files.size(); ++i) std::tie(stamps_ns[i], files[i]) = sorted[i];
}

void skip_unpaired(const std::vector<fs::path>& images, const std::set<fs::path>& paired, const char* other,
                   SkippedFrames& skipped) {
  for (const fs::path& image : images) {
    if (paired.contains(image)) continue;
    skipped.add({image.filename().string(),
                 fmt::format("{}: no {} image of this name or time", image.string(), other)});
  }
}

struct PairedImages {
  std::set<fs::path> color, depth;
};

PairedImages paired_images(const std::vector<RecordedFrame>& frames) {
  PairedImages paired;
  for (const RecordedFrame& frame : frames) {
    paired.color.insert(frame.color.file);
    paired.depth.insert(frame.depth.file);
  }
  return paired;
}

UnpairedImages unpaired_of(const std::vector<fs::path>& images, const std::set<fs::path>& paired) {
  UnpairedImages unpaired{0, images.size(), {}};
  for (const fs::path& image : images) {
    if (paired.contains(image)) continue;
    if (unpaired.count++ == 0) unpaired.first = image;
  }
  return unpaired;
}

/// An image that one camera made between two of the other is not lost.
bool is_one_faster(size_t color, size_t depth) {
  constexpr double kRatio = 1.5;  // of the rates; the usual ones are 15 and 30 Hz
  constexpr size_t kFewest = 10;  // fewer images tell no rate
  const auto [fewer, more] = std::minmax(color, depth);
  return fewer >= kFewest && static_cast<double>(more) >= kRatio * static_cast<double>(fewer);
}

}  // namespace

void pair_folders(const fs::path& color_folder, const fs::path& depth_folder, double fps,
                  RecordedSequence& sequence) {
  const auto depth = without_pictures_of_arrays(images_in(depth_folder, is_depth_name));
  pair_images(images_in(color_folder, is_color_name), depth, fps, sequence);
}

void pair_images(std::vector<fs::path> color, std::vector<fs::path> depth, double fps,
                 RecordedSequence& sequence) {
  auto times = times_of_names(color, depth);
  if (times) {
    sort_by_time(color, times->color.stamps_ns);
    sort_by_time(depth, times->depth.stamps_ns);
  }
  sequence.stamps_measured = times.has_value();
  Pairing chosen;
  for (const auto& [c, d] : choose_pairs(color, depth, times, chosen)) {
    const int64_t color_ns = times ? times->color.stamps_ns[c] : 0;
    const bool one_clock = times && !chosen.by_order;  // else times of depth say nothing here
    const int64_t depth_ns = one_clock ? times->depth.stamps_ns[d] : color_ns;
    sequence.frames.push_back({color_ns, depth_ns, {color[c]}, {depth[d]}, {}, 0});
  }
  if (times) {
    keep_increasing(sequence);
  } else {
    stamp_by_rate(sequence.frames, fps);
  }
  if (std::all_of(depth.begin(), depth.end(), is_raw)) sequence.depth_encoding = DepthEncoding::kRawUint16;
  sequence.pairing = pairing_of(sequence.frames, color, depth);
  sequence.pairing.rule = chosen.rule;
  sequence.pairing.by_order = chosen.by_order;
  if (times) sequence.pairing.times = text_of(*times);
  if (is_one_faster(color.size(), depth.size())) return;
  const PairedImages paired = paired_images(sequence.frames);
  skip_unpaired(color, paired.color, "depth", sequence.skipped);
  skip_unpaired(depth, paired.depth, "colour", sequence.skipped);
}

Pairing pairing_of(const std::vector<RecordedFrame>& frames, const std::vector<fs::path>& color,
                   const std::vector<fs::path>& depth) {
  const PairedImages paired = paired_images(frames);
  Pairing pairing;
  pairing.color = unpaired_of(color, paired.color);
  pairing.depth = unpaired_of(depth, paired.depth);
  return pairing;
}

std::string nearest_time_rule() {
  return fmt::format("of the nearest time within {} s", to_seconds(kMaxAssociationNs));
}

std::string unpaired_text(const Pairing& pairing) {
  std::string text;
  const auto add = [&](const UnpairedImages& images, const char* kind) {
    if (images.count == 0) return;
    text += fmt::format("{}{} of {} {} images, the first: {}", text.empty() ? "" : "; ", images.count,
                        images.of, kind, images.first.filename().string());
  };
  add(pairing.color, "colour");
  add(pairing.depth, "depth");
  return text;
}

void tell_pairing(const std::string& name, const Pairing& pairing) {
  if (pairing.by_order)
    log::warn(
        "{}: colour and depth images are paired by their order, as neither equal names nor times tell which "
        "belong together; if one is missing, all pairs after it are wrong: write associations.txt then",
        name);
  if (!pairing.times.empty())
    log::info("{}: {}{}{}", name, pairing.times, pairing.rule.empty() ? "" : "; pairs ", pairing.rule);
  const std::string unpaired = unpaired_text(pairing);
  if (!unpaired.empty()) log::info("{}: without a partner and not used: {}", name, unpaired);
}

}  // namespace kinloop
