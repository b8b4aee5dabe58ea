// Paintings and rooms are the same with every compiler. C++ leaves open in which order the arguments of a
// call are evaluated: gcc on x86 goes from the last to the first, clang and gcc on ARM from the first to the
// last. Where two arguments of one call draw random numbers, each compiler makes another room. The numbers
// below are from gcc 12 on x86. They are means and sums, not hashes of bytes: versions of OpenCV round
// differently.

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "simulator/paint/paint.hpp"
#include "simulator/paint/palette.hpp"
#include "simulator/room/room_layout.hpp"

namespace kinloop::sim {
namespace {

TEST(SimulationOrder, PaintingsDoNotDependOnTheCompiler) {
  struct Painted {
    std::string name;
    cv::Mat (*paint)(Random&);
    std::array<double, 3> mean_bgr;
  };
  const std::vector<Painted> all{
      {"plaster", paint_plaster, {227.10, 232.10, 233.10}},
      {"bricks", paint_bricks, {89.13, 109.55, 141.30}},
      {"planks", paint_planks, {117.30, 151.98, 183.65}},
      {"tiles", paint_tiles, {176.41, 188.65, 193.89}},
      {"wood", paint_wood, {135.84, 169.04, 199.14}},
      {"cardboard", paint_cardboard, {130.62, 164.26, 189.34}},
      {"leaf", paint_leaf, {100.59, 164.77, 96.16}},
      {"rug", paint_rug, {125.73, 89.68, 147.52}},
      {"landscape", paint_landscape, {128.08, 119.66, 93.94}},
      {"abstract", paint_abstract, {106.67, 106.83, 103.85}},
      {"poster", paint_poster, {205.20, 204.30, 197.79}},
      {"map", paint_map, {177.88, 206.63, 203.84}},
      {"whiteboard", paint_whiteboard, {219.93, 218.88, 220.02}},
      {"window_view", paint_window_view, {178.44, 175.06, 153.63}},
      {"paper", paint_paper, {213.34, 210.87, 208.20}},
      {"screen", paint_screen, {95.43, 107.25, 85.20}},
      {"label", paint_label, {179.07, 176.97, 183.65}},
      {"book_spines", paint_book_spines, {111.44, 113.13, 109.42}},
  };
  constexpr double kTolerance = 0.3;
  for (const Painted& painted : all) {
    Random random(1);
    const cv::Scalar mean = cv::mean(painted.paint(random));
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_NEAR(mean[channel], painted.mean_bgr[static_cast<size_t>(channel)], kTolerance)
          << painted.name << ", channel " << channel;
    }
  }
}

/// A number to which every part contributes.
double spread(const Parts& parts) {
  double sum = 0;
  for (const Primitive& part : parts) {
    sum += static_cast<double>(part.center.cwiseAbs().sum() + part.half.dot(Eigen::Vector3f(4, 5, 6)));
    sum += static_cast<double>(std::abs(part.R_room_local(0, 0)) + part.face_texture.u0);
  }
  return sum;
}

TEST(SimulationOrder, RoomsDoNotDependOnTheCompiler) {
  struct Built {
    uint64_t seed = 0;
    size_t parts = 0;
    double spread = 0;
  };
  const Palette palette(1, 2);
  for (const Built& built : {Built{1, 710, 5471.287}, Built{2, 1111, 8111.147}, Built{3, 850, 6261.416}}) {
    RoomLayout layout(palette, {6.0F, 5.2F, 2.8F}, {}, built.seed);
    const Parts parts = layout.release_parts();
    EXPECT_EQ(parts.size(), built.parts) << "seed " << built.seed;
    EXPECT_NEAR(spread(parts), built.spread, 0.01) << "seed " << built.seed;
  }
}

}  // namespace
}  // namespace kinloop::sim
