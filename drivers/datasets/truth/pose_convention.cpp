#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "drivers/datasets/reading/matrix_text.hpp"
#include "drivers/datasets/recorded_source.hpp"
#include "drivers/datasets/truth/truth.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

constexpr size_t kConventions = 4;

/// The plainest first: it is taken if nothing tells.
constexpr std::array<PoseConvention, kConventions> kPoseConventions = {{
    {false, false},
    {false, true},
    {true, false},
    {true, true},
}};

/// How many points of the first frame agree with what the second one sees there.
struct Agreement {
  size_t points = 0, agreeing = 0;

  [[nodiscard]] double share() const {
    return points == 0 ? 0 : static_cast<double>(agreeing) / static_cast<double>(points);
  }
};

bool sees_point(const Frame& frame, const PinholeCamera& lens, const Eigen::Vector3d& p_camera, int gray) {
  constexpr double kShare = 0.02, kLeast_m = 0.01;
  constexpr int kMostDifference = 25;
  if (p_camera.z() <= 0) return false;
  const Eigen::Vector2d pixel = lens.project(p_camera);
  const cv::Mat& image = frame.color.gray();
  const bool inside =
      pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < image.cols - 1 && pixel.y() < image.rows - 1;
  if (!inside) return false;
  const auto x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
  const double depth_m = frame.depth_m.at<float>(y, x);
  return std::abs(depth_m - p_camera.z()) < kShare * p_camera.z() + kLeast_m &&
         std::abs(image.at<uint8_t>(y, x) - gray) < kMostDifference;
}

void add_agreement(const Frame& first, const Frame& second, const SE3& T_second_first,
                   const PinholeCamera& lens, Agreement& agreement) {
  constexpr int kGrid = 40;
  const cv::Mat& gray = first.color.gray();
  const int step_x = std::max(1, gray.cols / kGrid), step_y = std::max(1, gray.rows / kGrid);
  for (int y = 0; y < gray.rows; y += step_y) {
    for (int x = 0; x < gray.cols; x += step_x) {
      const double depth_m = first.depth_m.at<float>(y, x);
      if (!(depth_m > 0)) continue;
      const Eigen::Vector3d p_first = lens.unproject({x, y}, depth_m);
      ++agreement.points;
      agreement.agreeing +=
          sees_point(second, lens, T_second_first * p_first, gray.at<uint8_t>(y, x)) ? 1 : 0;
    }
  }
}

/// The images of the pairs by their time. Damaged frames are not among them.
std::map<int64_t, Frame> frames_of(const std::vector<FramePair>& pairs, const RecordedSequence& sequence,
                                   const RgbdCamera& camera) {
  std::vector<size_t> used;
  for (const FramePair& pair : pairs) used.insert(used.end(), {pair.first, pair.second});
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  RecordedSequence some;
  some.depth_encoding = sequence.depth_encoding;
  for (const size_t i : used) some.frames.push_back(sequence.frames[i]);
  std::map<int64_t, Frame> frames;
  try {
    RecordedSource source("", std::move(some), camera);
    while (auto frame = source.next()) {
      const int64_t stamp_ns = frame->stamp_ns;
      frames.emplace(stamp_ns, *std::move(frame));
    }
  } catch (const InputError&) {
    frames.clear();  // said when the sequence is read
  }
  return frames;
}

}  // namespace

SE3 to_world_from_camera(const SE3& written, const PoseConvention& convention) {
  const SE3 T_world_written = convention.is_inverse ? written.inverse() : written;
  return convention.has_y_up ? from_arkit(T_world_written) : T_world_written;
}

std::vector<FramePair> pairs_for_convention(const WrittenPoses& poses) {
  constexpr size_t kPairs = 12, kFarthest = 60, kOtherwise = 15;
  constexpr double kDegree = std::numbers::pi / 180, kLeast_rad = 4 * kDegree, kMost_rad = 20 * kDegree;
  std::vector<size_t> known;
  for (size_t i = 0; i < poses.frames.size(); ++i) {
    if (poses.frames[i]) known.push_back(i);
  }
  std::vector<FramePair> pairs;
  const size_t step = std::max<size_t>(1, known.size() / kPairs);
  for (size_t a = 0; a + 1 < known.size(); a += step) {
    size_t b = std::min(a + kOtherwise, known.size() - 1);
    for (size_t other = a + 1; other < std::min(a + kFarthest, known.size()); ++other) {
      const double angle_rad = (poses.frames[known[a]]->inverse() * *poses.frames[known[other]]).angle_rad();
      if (angle_rad < kLeast_rad || angle_rad > kMost_rad) continue;
      b = other;
      break;
    }
    pairs.push_back({known[a], known[b]});
  }
  return pairs;
}

PoseConvention find_pose_convention(const WrittenPoses& poses, const RecordedSequence& sequence,
                                    const RgbdCamera& camera) {
  constexpr double kClearly = 1.2, kLeast = 0.2;
  const auto pairs = pairs_for_convention(poses);
  const auto frames = frames_of(pairs, sequence, camera);
  std::array<Agreement, kConventions> agreements;
  for (const FramePair& pair : pairs) {
    const auto first = frames.find(sequence.frames[pair.first].stamp_ns),
               second = frames.find(sequence.frames[pair.second].stamp_ns);
    if (first == frames.end() || second == frames.end()) continue;
    for (size_t i = 0; i < kConventions; ++i) {
      const SE3 T_world_first = to_world_from_camera(*poses.frames[pair.first], kPoseConventions[i]),
                T_world_second = to_world_from_camera(*poses.frames[pair.second], kPoseConventions[i]);
      add_agreement(first->second, second->second, T_world_second.inverse() * T_world_first, camera.color,
                    agreements[i]);
    }
  }
  size_t best = 0;
  for (size_t i = 1; i < kConventions; ++i) {
    if (agreements[i].share() > agreements[best].share()) best = i;
  }
  PoseConvention found = kPoseConventions[best];
  found.agreement = agreements[best].share();
  for (size_t i = 0; i < kConventions; ++i) {
    if (i != best) found.next_best = std::max(found.next_best, agreements[i].share());
  }
  found.is_certain = found.agreement > kLeast && found.agreement > kClearly * found.next_best;
  if (found.is_certain) return found;
  PoseConvention plain = kPoseConventions.front();
  plain.agreement = found.agreement, plain.next_best = found.next_best;
  return plain;
}

void find_truth(const fs::path& folder, const RgbdCamera& camera, RecordedSequence& sequence) {
  std::error_code absent;
  if (!sequence.ground_truth.empty() || !sequence.video.empty() || !fs::is_directory(folder, absent)) return;
  const auto poses = find_written_poses(folder, sequence);
  if (!poses) return;
  const PoseConvention convention = find_pose_convention(*poses, sequence, camera);
  for (size_t i = 0; i < poses->frames.size(); ++i) {
    if (!poses->frames[i]) continue;
    sequence.ground_truth.push_back(
        {sequence.frames[i].stamp_ns, to_world_from_camera(*poses->frames[i], convention)});
  }
  if (!convention.is_certain) {
    log::warn(
        "ground truth of {}: taken as world from camera in OpenCV's axes, which the images do not confirm "
        "({:.0f} % of the depth agrees with the best convention, {:.0f} % with the next)",
        poses->name, 100 * convention.agreement, 100 * convention.next_best);
    return;
  }
  log::info(
      "ground truth of {}: {} poses, {} in {} axes ({:.0f} % of the depth agrees between frames, at most "
      "{:.0f} % otherwise)",
      poses->name, sequence.ground_truth.size(),
      convention.is_inverse ? "camera from world" : "world from camera",
      convention.has_y_up ? "OpenGL's" : "OpenCV's", 100 * convention.agreement, 100 * convention.next_best);
}

}  // namespace kinloop
