// Ground truth that lies beside images in a file of unknown convention.

#include <functional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include "drivers/datasets/open_sequence.hpp"
#include "drivers/datasets/truth/truth.hpp"
#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "simulator/simulated_source.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using test::TempFolder;

constexpr uint64_t kTruthSeed = 43;

/// Frames of a simulated room, some degrees apart, with the true poses.
struct TruthSample {
  RgbdCamera camera;
  std::vector<Frame> frames;
  std::vector<SE3> poses;
};

const TruthSample& truth_sample() {
  static const TruthSample sample = [] {
    constexpr size_t kFrames = 10, kStep = 8;
    SimulationOptions options;
    options.width = 320;
    options.height = 240;
    const SimulatedSource source("sim:room", kTruthSeed, options, 2);
    TruthSample made{source.camera(), {}, {}};
    for (size_t i = 0; i < kFrames; ++i) {
      made.frames.push_back(source.frame(i * kStep));
      made.poses.push_back(source.info().ground_truth[i * kStep].T_world_camera);
    }
    return made;
  }();
  return sample;
}

SE3 as_written(const SE3& T_world_camera, const PoseConvention& convention) {
  static const SE3 kHalfTurn{Eigen::Quaterniond(0, 1, 0, 0), Eigen::Vector3d::Zero()};
  const SE3 T = convention.has_y_up ? T_world_camera * kHalfTurn : T_world_camera;
  return convention.is_inverse ? T.inverse() : T;
}

std::string matrix_text(const SE3& T, int rows = 4, const char* line_end = " ") {
  const Eigen::Matrix4d m = T.matrix();
  std::string text;
  for (int i = 0; i < rows; ++i)
    text += fmt::format("{:.12g} {:.12g} {:.12g} {:.12g}{}", m(i, 0), m(i, 1), m(i, 2), m(i, 3), line_end);
  return text + "\n";
}

std::string pose_text(const SE3& T) {
  const auto& t = T.translation;
  const auto& q = T.rotation;
  return fmt::format("{:.12g} {:.12g} {:.12g} {:.12g} {:.12g} {:.12g} {:.12g}\n", t.x(), t.y(), t.z(), q.x(),
                     q.y(), q.z(), q.w());
}

/// rgb/ and depth/ with the frames of the sample, and its camera.
class TruthFolder : public testing::Test {
 protected:
  TruthFolder() {
    std::filesystem::create_directories(folder_.path() / "rgb");
    std::filesystem::create_directories(folder_.path() / "depth");
    for (size_t i = 0; i < truth_sample().frames.size(); ++i) {
      const Frame& frame = truth_sample().frames[i];
      write_png(folder_.path() / fmt::format("rgb/{}.png", i), frame.color.bgr());
      write_depth_png(folder_.path() / fmt::format("depth/{}.png", i), frame.depth_m,
                      truth_sample().camera.depth_scale);
    }
    write_camera_file(folder_.path() / "camera.yaml", truth_sample().camera);
  }

  [[nodiscard]] Trajectory truth() const { return read_sequence(folder_.path()).sequence.ground_truth; }

  /// Writes a pose for each frame.
  void write_poses(const char* file, const PoseConvention& convention,
                   const std::function<std::string(const SE3&)>& text) const {
    std::string all;
    for (const SE3& T : truth_sample().poses) all += text(as_written(T, convention));
    folder_.write(file, all);
  }

  void expect_truth(size_t count = truth_sample().poses.size()) const {
    const Trajectory found = truth();
    ASSERT_EQ(found.size(), count);
    for (const StampedPose& pose : found) {
      const auto i = static_cast<size_t>(std::lround(30 * to_seconds(pose.stamp_ns)));
      const SE3 error = truth_sample().poses[i].inverse() * pose.T_world_camera;
      EXPECT_LT(error.translation.norm() + error.angle_rad(), 1e-6);
    }
  }

  TempFolder folder_;
};

constexpr PoseConvention kConventionsWritten[] = {{false, false}, {false, true}, {true, false}, {true, true}};

TEST_F(TruthFolder, IsReadInEachConvention) {
  for (const PoseConvention& convention : kConventionsWritten) {
    SCOPED_TRACE(fmt::format("inverse {}, y up {}", convention.is_inverse, convention.has_y_up));
    write_poses("poses.txt", convention, [](const SE3& T) { return matrix_text(T); });
    expect_truth();
  }
}

TEST_F(TruthFolder, IsReadInEachFormOfLines) {
  struct Form {
    const char* file;
    std::function<std::string(const SE3&)> text;
  };
  int line = 0;
  const Form forms[] = {
      {"poses.txt", [](const SE3& T) { return matrix_text(T, 3); }},
      {"traj.txt", [](const SE3& T) { return matrix_text(T); }},
      {"gt.txt", [](const SE3& T) { return matrix_text(T, 4, "\n"); }},
      {"pose.txt", pose_text},
      {"groundtruth.txt", [&](const SE3& T) { return fmt::format("{} {}", line++, pose_text(T)); }},
  };
  for (const Form& form : forms) {
    SCOPED_TRACE(form.file);
    write_poses(form.file, {true, true}, form.text);
    expect_truth();
    std::filesystem::remove(folder_.path() / form.file);
  }
}

TEST_F(TruthFolder, MayBeAFileForEachFrame) {
  for (const char* folder : {"pose", "poses"}) {
    SCOPED_TRACE(folder);
    for (size_t i = 0; i < truth_sample().poses.size(); ++i)
      folder_.write(fmt::format("{}/{:06d}.txt", folder, i),
                    matrix_text(as_written(truth_sample().poses[i], {false, true}), 4, "\n"));
    std::filesystem::remove(folder_.path() / folder / "000003.txt");
    folder_.write(fmt::format("{}/000004.txt", folder), "inf inf inf inf inf inf inf inf inf inf inf inf");
    expect_truth(truth_sample().poses.size() - 2);
    std::filesystem::remove_all(folder_.path() / folder);
  }
}

TEST_F(TruthFolder, OfMorePosesThanFramesIsTakenByTheNumbersOfTheImages) {
  write_poses("poses.txt", {}, [](const SE3& T) { return matrix_text(T); });
  std::filesystem::remove(folder_.path() / "rgb/9.png");
  expect_truth(truth_sample().poses.size() - 1);
}

TEST_F(TruthFolder, ThatDoesNotBelongToTheFramesIsNotUsed) {
  folder_.write("poses.txt", matrix_text(truth_sample().poses[0]) + matrix_text(truth_sample().poses[1]));
  EXPECT_TRUE(truth().empty());
  folder_.write("poses.txt", "1 2 3\n");
  EXPECT_TRUE(truth().empty());
  folder_.write("poses.txt", "");
  EXPECT_TRUE(truth().empty());
}

TEST_F(TruthFolder, WithoutMotionNoConventionIsCertain) {
  WrittenPoses still{"poses.txt", {}};
  still.frames.assign(truth_sample().poses.size(), SE3{});
  OpenedSequence opened = read_sequence(folder_.path());
  EXPECT_FALSE(find_pose_convention(still, opened.sequence, opened.camera).is_certain);
}

TEST_F(TruthFolder, TellsHowMuchDepthAgrees) {
  WrittenPoses written{"poses.txt", {}};
  for (const SE3& T : truth_sample().poses) written.frames.emplace_back(as_written(T, {true, false}));
  OpenedSequence opened = read_sequence(folder_.path());
  const PoseConvention found = find_pose_convention(written, opened.sequence, opened.camera);
  EXPECT_TRUE(found.is_certain);
  EXPECT_TRUE(found.is_inverse);
  EXPECT_FALSE(found.has_y_up);
  EXPECT_GT(found.agreement, 0.5);
  EXPECT_LT(found.next_best, 0.5 * found.agreement);
}

}  // namespace
}  // namespace kinloop
