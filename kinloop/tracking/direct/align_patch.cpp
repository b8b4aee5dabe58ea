#include <algorithm>
#include <array>

#include <Eigen/LU>

#include "kinloop/tracking/direct/alignment.hpp"

namespace kinloop {
namespace {

using Texels = PatchTemplate::Texels;

constexpr float kHalf = (PatchTemplate::kSize - 1) / 2.0F;  // from the centre to the first texel

void subtract_mean(Texels& values) {
  values.array() -= values.mean();
}

/// Bilinear interpolation between texels. The caller checks that the position is inside.
float interpolate(const Patch& patch, float x, float y) {
  constexpr int kLast = Patch::kSize - 2;  // a rounded position may be that of the last texel
  const int column = std::min(static_cast<int>(x), kLast), row = std::min(static_cast<int>(y), kLast);
  const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
  const uint8_t* upper = patch.texels.data() + row * Patch::kSize + column;
  const uint8_t* lower = upper + Patch::kSize;
  const auto a = static_cast<float>(upper[0]), b = static_cast<float>(upper[1]);
  const auto c = static_cast<float>(lower[0]), d = static_cast<float>(lower[1]);
  return (1 - fy) * ((1 - fx) * a + fx * b) + fy * ((1 - fx) * c + fx * d);
}

/// The 8x8 pixels around a position at least 4 px inside the image.
void sample(const cv::Mat& image, const Eigen::Vector2f& position, Texels& values) {
  const float left = position.x() - kHalf, top = position.y() - kHalf;
  const int column = static_cast<int>(left), first_row = static_cast<int>(top);
  const float fx = left - static_cast<float>(column), fy = top - static_cast<float>(first_row);
  const float w00 = (1 - fx) * (1 - fy), w01 = fx * (1 - fy), w10 = (1 - fx) * fy, w11 = fx * fy;
  for (int row = 0; row < PatchTemplate::kSize; ++row) {
    const uint8_t* upper = image.ptr(first_row + row) + column;
    const uint8_t* lower = image.ptr(first_row + row + 1) + column;
    float* out = values.data() + row * PatchTemplate::kSize;
    for (int x = 0; x < PatchTemplate::kSize; ++x) {
      out[x] = w00 * static_cast<float>(upper[x]) + w01 * static_cast<float>(upper[x + 1]) +
               w10 * static_cast<float>(lower[x]) + w11 * static_cast<float>(lower[x + 1]);
    }
  }
}

bool is_inside(const cv::Mat& image, const Eigen::Vector2f& position) {
  constexpr float kMargin = kHalf + 1;
  return position.x() >= kMargin && position.y() >= kMargin &&
         position.x() < static_cast<float>(image.cols) - kMargin &&
         position.y() < static_cast<float>(image.rows) - kMargin;
}

}  // namespace

std::optional<PatchTemplate> make_template(const Patch& patch, const Eigen::Matrix2f& source_per_target) {
  constexpr int kBorder = PatchTemplate::kSize + 2;  // one more texel on each side, for gradients
  constexpr float kMinContrast = 3;                  // root mean square deviation, intensity levels
  constexpr float kReach = kHalf + 1;
  const Eigen::Array2f extent = source_per_target.cwiseAbs() * Eigen::Vector2f(kReach, kReach);
  const Eigen::Array2f low = patch.center.array() - extent, high = patch.center.array() + extent;
  if (!(low >= 0).all() || !(high < Patch::kSize - 1).all()) return std::nullopt;

  std::array<float, kBorder * kBorder> warped{};
  for (int row = 0; row < kBorder; ++row) {
    Eigen::Vector2f at =
        patch.center + source_per_target * Eigen::Vector2f(-kReach, static_cast<float>(row) - kReach);
    for (int x = 0; x < kBorder; ++x, at += source_per_target.col(0)) {
      warped.data()[row * kBorder + x] = interpolate(patch, at.x(), at.y());
    }
  }
  PatchTemplate made;
  for (int row = 0; row < PatchTemplate::kSize; ++row) {
    for (int x = 0; x < PatchTemplate::kSize; ++x) {
      const int to = row * PatchTemplate::kSize + x;
      const float* from = warped.data() + (row + 1) * kBorder + x + 1;
      made.intensity[to] = *from;
      made.gradient_x[to] = (from[1] - from[-1]) / 2;
      made.gradient_y[to] = (from[kBorder] - from[-kBorder]) / 2;
    }
  }
  subtract_mean(made.intensity);
  const float norm = made.intensity.norm();
  if (!(norm > kMinContrast * PatchTemplate::kSize)) return std::nullopt;
  made.intensity /= norm;
  for (Texels* gradient : {&made.gradient_x, &made.gradient_y}) {
    *gradient /= norm;
    subtract_mean(*gradient);
    *gradient -= gradient->dot(made.intensity) * made.intensity;
  }
  Eigen::Matrix2f hessian;
  const float xy = made.gradient_x.dot(made.gradient_y);
  hessian << made.gradient_x.squaredNorm(), xy, xy, made.gradient_y.squaredNorm();
  // An edge without a corner slides along itself.
  constexpr float kMinCorner = 0.02F;  // smallest curvature of the correlation, per px^2
  if (!(hessian.determinant() > kMinCorner * hessian.trace())) return std::nullopt;
  made.inverse_hessian = hessian.inverse();
  return made;
}

std::optional<AlignedPatch> align_patch(const PatchTemplate& patch, const cv::Mat& image,
                                        const Eigen::Vector2f& guess, float max_shift_px) {
  constexpr int kMaxIterations = 10;
  constexpr float kConverged_px = 0.03F;
  constexpr float kMinSimilarity = 0.1F;  // a smaller gain says nothing about the direction
  AlignedPatch found{guess};
  Texels values;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    if (!is_inside(image, found.position)) return std::nullopt;
    sample(image, found.position, values);
    subtract_mean(values);
    const float norm = values.norm();
    const float gain = values.dot(patch.intensity);
    if (!(gain > kMinSimilarity * norm)) return std::nullopt;
    found.correlation = gain / norm;
    const Eigen::Vector2f slope(values.dot(patch.gradient_x), values.dot(patch.gradient_y));
    const Eigen::Vector2f step = patch.inverse_hessian * slope / gain;
    found.position -= step;
    if ((found.position - guess).norm() > max_shift_px) return std::nullopt;
    if (step.norm() < kConverged_px) return found;
  }
  return std::nullopt;
}

}  // namespace kinloop
