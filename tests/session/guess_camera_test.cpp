#include "session/input/guess_camera.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "drivers/image_files/image_file.hpp"
#include "session/plan/run_plan.hpp"
#include "simulator/simulated_source.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using testing::HasSubstr;

/// Writes the middle of each frame of a simulated room, without a camera; returns its focal length.
double write_cropped_room(const std::filesystem::path& folder, uint64_t seed, int frames, double share) {
  SimulationOptions options;
  options.width = 320;
  options.height = 240;
  const SimulatedSource source("sim:room", seed, options, 2);
  const cv::Size size(static_cast<int>(320 * share), static_cast<int>(240 * share));
  const cv::Rect middle({(320 - size.width) / 2, (240 - size.height) / 2}, size);
  for (const char* name : {"rgb", "depth"}) std::filesystem::create_directories(folder / name);
  for (int i = 0; i < frames; ++i) {
    const Frame frame = source.frame(static_cast<size_t>(i));
    write_png(folder / fmt::format("rgb/{}.png", i), frame.color.bgr()(middle).clone());
    write_depth_png(folder / fmt::format("depth/{}.png", i), frame.depth_m(middle).clone(), 5000);
  }
  return source.camera().color.fx;
}

TEST(GuessedCamera, HasTheFocalLengthOfTheImages) {
  constexpr uint64_t kSeed = 44;
  constexpr double kShare = 0.875, kScale = 5000;
  const test::TempFolder folder;
  const double truth_px = write_cropped_room(folder.path(), kSeed, 150, kShare);
  const GuessedCamera guess = guess_camera(folder.path().string(), kScale);
  EXPECT_TRUE(guess.is_certain);
  EXPECT_NEAR(guess.description.camera.color.fx / truth_px, 1, 0.03);
  EXPECT_LT(guess.sigma, 0.02);
}

TEST(GuessedCamera, IsNotCertainWithoutMotion) {
  const test::TempFolder folder;
  write_cropped_room(folder.path(), 44, 2, 1);
  const GuessedCamera guess = guess_camera(folder.path().string(), 5000);
  EXPECT_FALSE(guess.is_certain);
  EXPECT_EQ(guess.sigma, 0);
  EXPECT_NEAR(guess.description.camera.color.fx, 320 * 525.0 / 640, 1e-9);
}

TEST(GuessedCamera, IsForFoldersOnly) {
  RunRequest request;
  request.source.sequence = "sim:room";
  request.camera.camera = "guess";
  EXPECT_THAT(test::usage_error([&] { plan_run(request); }), HasSubstr("--camera guess: for folders"));
}

}  // namespace
}  // namespace kinloop
