#include "apps/run/summary/loop_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/map/frames/frame_velocities.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"

namespace kinloop {
namespace {

using nlohmann::json;
using Landmarks = std::vector<ReprojectedLandmark>;

constexpr size_t kMaxPictures = 12;
constexpr int kImageWidthPx = 560;  // width of each of the two
constexpr int kJpegQuality = 75;
constexpr const char* kIndexName = "loops.json";
constexpr std::string_view kExtension = ".jpg";

/// A loop to draw, with the pair of keyframes that shows it best.
struct ShownLoop {
  LoopClosure loop;
  KeyframePair pair;
};

/// Selects evenly spaced loops, each with its own pair of keyframes.
std::vector<ShownLoop> choose_loops(const Map& map) {
  std::vector<ShownLoop> distinct;
  for (const LoopClosure& loop : map.loop_closures()) {
    const KeyframePair pair = most_overlapping_pair(map, loop);
    const bool shown = std::any_of(distinct.begin(), distinct.end(), [&](const ShownLoop& other) {
      return other.pair.older == pair.older || other.pair.newer == pair.newer;
    });
    if (!shown) distinct.push_back({loop, pair});
  }
  const size_t count = std::min(kMaxPictures, distinct.size());
  std::vector<ShownLoop> chosen;
  for (size_t i = 0; i < count; ++i) chosen.push_back(distinct[i * distinct.size() / count]);
  return chosen;
}

/// Whether a nearer surface occludes the landmark in the second camera.
bool hidden(const ReprojectedLandmark& landmark, const cv::Mat& depth_m) {
  constexpr double kNearer = 0.9;
  if (landmark.observed_in_second) return false;
  const cv::Point at(cvRound(landmark.predicted.x()), cvRound(landmark.predicted.y()));
  const auto seen_m = static_cast<double>(depth_m.at<float>(at));
  return seen_m > 0 && seen_m < kNearer * landmark.depth_m;
}

/// Bounding box of the landmarks in the first image.
Eigen::AlignedBox2d bounding_box(const Landmarks& landmarks) {
  Eigen::AlignedBox2d extent;
  for (const auto& landmark : landmarks) extent.extend(landmark.observed);
  return extent;
}

/// A colour by position in the extent, so that points can be recognised in the second image.
cv::Scalar color_at(const Eigen::Vector2d& pixel, const Eigen::AlignedBox2d& extent) {
  constexpr double kRedToViolet = 150, kMaxCount = 255, kMinSaturation = 0.4;  // in OpenCV's units
  const Eigen::Vector2d share =
      (pixel - extent.min()).cwiseQuotient(extent.sizes().cwiseMax(1)).cwiseMax(0).cwiseMin(1);
  const cv::Scalar hsv(kRedToViolet * share.x(), kMaxCount * (1 - (1 - kMinSaturation) * share.y()),
                       kMaxCount);
  cv::Mat color(1, 1, CV_8UC3, hsv);
  cv::cvtColor(color, color, cv::COLOR_HSV2BGR);
  return color.at<cv::Vec3b>(0);
}

/// Draws a dot with a dark rim, or a ring for landmarks not observed again.
void mark(cv::Mat& picture, const cv::Point2d& at, const cv::Scalar& color, bool filled) {
  constexpr int kShift = 4, kRadius = 4 << kShift, kRim = 1 << kShift;
  const cv::Point fine(cvRound(at.x * (1 << kShift)), cvRound(at.y * (1 << kShift)));
  if (!filled) {
    cv::circle(picture, fine, kRadius, color, 1, cv::LINE_AA, kShift);
    return;
  }
  cv::circle(picture, fine, kRadius + kRim, {0, 0, 0}, cv::FILLED, cv::LINE_AA, kShift);
  cv::circle(picture, fine, kRadius, color, cv::FILLED, cv::LINE_AA, kShift);
}

/// Selects some of the landmarks observed in both images, from the top to the bottom of the first.
Landmarks sample_common_landmarks(const Landmarks& landmarks) {
  constexpr size_t kMaxCount = 24;
  Landmarks both, some;
  std::copy_if(landmarks.begin(), landmarks.end(), std::back_inserter(both),
               [](const auto& landmark) { return landmark.observed_in_second.has_value(); });
  std::stable_sort(both.begin(), both.end(),
                   [](const auto& a, const auto& b) { return a.observed.y() < b.observed.y(); });
  const size_t count = std::min(kMaxCount, both.size());
  for (size_t i = 0; i < count; ++i) some.push_back(both[i * both.size() / count]);
  return some;
}

/// Draws both images side by side with the landmarks of the first in both; lines join some that both observe.
cv::Mat draw_loop(const cv::Mat& first, const cv::Mat& second, const Landmarks& landmarks) {
  const double scale = std::min(1.0, static_cast<double>(kImageWidthPx) / first.cols);
  cv::Mat side_by_side, picture;
  cv::hconcat(first, second, side_by_side);
  cv::resize(side_by_side, picture, {}, scale, scale, cv::INTER_AREA);
  const auto in_picture = [&](const Eigen::Vector2d& raw, int columns_before) {
    return cv::Point2d((raw.x() + columns_before + 0.5) * scale - 0.5, (raw.y() + 0.5) * scale - 0.5);
  };
  const auto extent = bounding_box(landmarks);
  for (const auto& landmark : sample_common_landmarks(landmarks)) {
    cv::line(picture, in_picture(landmark.observed, 0), in_picture(landmark.predicted, first.cols),
             color_at(landmark.observed, extent), 1, cv::LINE_AA);
  }
  for (const bool filled : {false, true}) {
    for (const auto& landmark : landmarks) {
      if (landmark.observed_in_second.has_value() != filled) continue;
      const cv::Scalar color = color_at(landmark.observed, extent);
      mark(picture, in_picture(landmark.observed, 0), color, filled);
      mark(picture, in_picture(landmark.predicted, first.cols), color, filled);
    }
  }
  return picture;
}

LoopPicture describe(const ShownLoop& shown, const Landmarks& landmarks, const Map& map) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  const Keyframe &a = map.keyframe(shown.pair.older), &b = map.keyframe(shown.pair.newer);
  const SE3 T_a_b = a.T_world_camera.inverse() * b.T_world_camera;
  std::vector<double> errors_px;
  for (const auto& landmark : landmarks) {
    if (landmark.observed_in_second)
      errors_px.push_back((*landmark.observed_in_second - landmark.predicted).norm());
  }
  LoopPicture picture;
  picture.file = fmt::format("{}_{}{}", format_stamp(a.stamp_ns), format_stamp(b.stamp_ns), kExtension);
  picture.stamp_a_ns = a.stamp_ns;
  picture.stamp_b_ns = b.stamp_ns;
  picture.reprojected = static_cast<int>(landmarks.size());
  picture.observed = static_cast<int>(errors_px.size());
  picture.median_error_px = median(errors_px);
  picture.distance_m = T_a_b.translation.norm();
  picture.angle_deg = kDegrees * log_so3(T_a_b.rotation).norm();
  picture.inliers = shown.loop.evidence.inliers;
  return picture;
}

/// A picture as JPEG.
struct DrawnLoop {
  LoopPicture picture;
  std::vector<uint8_t> jpeg;
};

/// Draws a loop; nothing if one of its images was not recorded.
std::optional<DrawnLoop> draw(const ShownLoop& shown, const Map& map, const MovingSensor& newer,
                              const DenseRecorder& recorder) {
  const auto first = recorder.images_of(map.keyframe(shown.pair.older).frame);
  const auto second = recorder.images_of(map.keyframe(shown.pair.newer).frame);
  if (!first || !second) return std::nullopt;
  Landmarks landmarks = reproject_landmarks(map, shown.pair.older, shown.pair.newer, newer);
  std::erase_if(landmarks, [&](const auto& landmark) { return hidden(landmark, second->depth_m); });
  const cv::Mat picture = draw_loop(first->color, second->color, landmarks);
  return DrawnLoop{describe(shown, landmarks, map), encode_jpeg(picture, kJpegQuality)};
}

json to_json(const LoopPicture& picture) {
  return {{"file", picture.file},
          {"stamp_a", format_stamp(picture.stamp_a_ns)},
          {"stamp_b", format_stamp(picture.stamp_b_ns)},
          {"reprojected", picture.reprojected},
          {"observed", picture.observed},
          {"median_error_px", picture.median_error_px},
          {"distance_m", picture.distance_m},
          {"angle_deg", picture.angle_deg},
          {"inliers", picture.inliers}};
}

/// A count of the index. Throws InputError if it is not a whole number that int holds.
int take_count(const json& entry, const char* key) {
  const auto& value = entry.at(key);
  if (!value.is_number_unsigned() || value.get<uint64_t>() > std::numeric_limits<int>::max())
    throw InputError(fmt::format("\"{}\": expected a whole number", key));
  return static_cast<int>(value.get<uint64_t>());
}

LoopPicture from_json(const json& entry) {
  const auto stamp = [&](const char* key) {
    return parse_stamp_ns(entry.at(key).get_ref<const std::string&>()).value_or(0);
  };
  // Only a file name, not a path: a report must not include files from elsewhere.
  const std::filesystem::path file = entry.at("file").get<std::string>();
  return {file.filename().string(),
          stamp("stamp_a"),
          stamp("stamp_b"),
          take_count(entry, "reprojected"),
          take_count(entry, "observed"),
          entry.at("median_error_px"),
          entry.at("distance_m"),
          entry.at("angle_deg"),
          take_count(entry, "inliers")};
}

/// Returns whether `text` is a stamp as in the name of a picture.
bool is_stamp(std::string_view text) {
  const auto stamp_ns = parse_stamp_ns(text);
  return stamp_ns && format_stamp(*stamp_ns) == text;
}

/// Returns whether a file has the name of a picture, STAMP_STAMP.jpg.
bool is_picture_name(std::string_view name) {
  if (!name.ends_with(kExtension)) return false;
  const std::string_view stamps = name.substr(0, name.size() - kExtension.size());
  const size_t middle = stamps.find('_');
  return middle != std::string_view::npos && is_stamp(stamps.substr(0, middle)) &&
         is_stamp(stamps.substr(middle + 1));
}

/// Returns whether a file is a JPEG image: not a link, which may lead to any file.
bool is_picture(const std::filesystem::path& file) {
  constexpr uintmax_t kMaxBytes = uintmax_t{16} << 20;
  std::error_code absent;
  return std::filesystem::is_regular_file(std::filesystem::symlink_status(file, absent)) &&
         std::filesystem::file_size(file, absent) <= kMaxBytes && jpeg_size(read_file(file)).has_value();
}

/// Removes the pictures of an earlier run but no other files, which belong to the user.
void remove_pictures(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (is_picture_name(name) || name == kIndexName) std::filesystem::remove(entry.path(), ignored);
  }
}

}  // namespace

void write_loop_pictures(const RunFolder& folder, const Slam& slam, const DenseRecorder& recorder) {
  remove_pictures(folder.loop_images());
  const Map& map = slam.map();
  const auto chosen = choose_loops(map);
  if (chosen.empty()) return;
  const auto velocities = keyframe_velocities(slam.log(), map);
  make_folder(folder.loop_images());
  std::vector<std::optional<DrawnLoop>> drawn(chosen.size());
  parallel_for(chosen.size(), hardware_threads(), [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const MovingSensor newer{slam.sensor(), velocities[chosen[i].pair.newer.value]};
      drawn[i] = draw(chosen[i], map, newer, recorder);
    }
  });
  json index = json::array();
  for (const auto& loop : drawn) {
    if (!loop) continue;
    write_file(folder.loop_images() / loop->picture.file,
               {reinterpret_cast<const char*>(loop->jpeg.data()), loop->jpeg.size()});
    index.push_back(to_json(loop->picture));
  }
  write_file(folder.loop_images() / kIndexName, json_text(index, 2) + "\n");
}

std::vector<LoopPicture> read_loop_pictures(const RunFolder& folder) {
  const auto path = folder.loop_images() / kIndexName;
  std::vector<LoopPicture> pictures;
  if (!std::filesystem::exists(path)) return pictures;
  const json index = parse_json(read_file(path));
  const auto fail = [&](const char* what) {
    throw InputError(
        fmt::format("{}: not the index of loop pictures that kinloop run writes ({}); remove "
                    "it to generate the report without loop images",
                    path.string(), what));
  };
  if (index.is_discarded()) fail("not JSON");
  try {
    for (const json& entry : index) pictures.push_back(from_json(entry));
  } catch (const json::exception& error) {
    fail(error.what());
  } catch (const InputError& error) {
    fail(error.what());
  }
  std::erase_if(pictures, [&](const LoopPicture& picture) {
    return picture.file.empty() || !is_picture(folder.loop_images() / picture.file);
  });
  return pictures;
}

}  // namespace kinloop
