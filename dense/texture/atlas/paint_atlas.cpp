#include "dense/texture/atlas/paint_atlas.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/core.hpp>

#include "dense/cloud/point_colors.hpp"
#include "kinloop/core/threads/parallel_for.hpp"

namespace kinloop {
namespace {

/// Fixed point of colours while contributions are added; offsets may exceed the range of a byte.
constexpr float kStepsPerLevel = 64;

/// What a triangle takes from a view: for each corner a share and, times this share, an offset.
struct Contribution {
  uint32_t view = 0, triangle = 0;
  Eigen::Vector3f share = Eigen::Vector3f::Zero();
  Eigen::Matrix3f offset_bgr = Eigen::Matrix3f::Zero();  ///< a column for each corner
};

/// Contributions of the views of a triangle's corners that see the triangle.
void add_contributions(const AtlasContent& content, uint32_t triangle, std::vector<Contribution>& all) {
  if (content.view_of_triangle[triangle] == kNoView) return;
  const size_t first = all.size();
  for (const ViewCandidate& seen : content.candidates[triangle]) {
    Contribution added{seen.view, triangle};
    for (int k = 0; k < 3; ++k) {
      for (const VertexView& taken :
           content.vertex_views[content.mesh.triangles[triangle][static_cast<size_t>(k)]]) {
        if (taken.view != seen.view) continue;
        added.share(k) = 1;
        added.offset_bgr.col(k) = taken.offset_bgr;
      }
    }
    if (added.share.any()) all.push_back(added);
  }
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (size_t i = first; i < all.size(); ++i) sum += all[i].share;
  for (size_t i = first; i < all.size(); ++i) {
    all[i].share.array() /= sum.array();
    all[i].offset_bgr *= all[i].share.asDiagonal();
  }
}

/// Those of all triangles, by view.
std::vector<Contribution> contributions_of(const AtlasContent& content) {
  std::vector<Contribution> all;
  for (uint32_t i = 0; i < content.mesh.triangles.size(); ++i) add_contributions(content, i, all);
  std::stable_sort(all.begin(), all.end(),
                   [](const Contribution& a, const Contribution& b) { return a.view < b.view; });
  return all;
}

/// Weights of the four pixels around a place between the middle two (Catmull and Rom 1974).
std::array<float, 4> cubic_weights(float t) {
  const float t2 = t * t, t3 = t2 * t;
  return {(-t + 2 * t2 - t3) / 2, (2 - 5 * t2 + 3 * t3) / 2, (t + 4 * t2 - 3 * t3) / 2, (t3 - t2) / 2};
}

/// Bicubic interpolation of an 8UC3 image, which continues with its border.
Eigen::Vector3f sample(const cv::Mat& image, const Eigen::Vector2f& pixel) {
  const Eigen::Vector2f inside(std::clamp(pixel.x(), 0.0F, static_cast<float>(image.cols - 1)),
                               std::clamp(pixel.y(), 0.0F, static_cast<float>(image.rows - 1)));
  const int col = static_cast<int>(inside.x()), row = static_cast<int>(inside.y());
  const auto along_x = cubic_weights(inside.x() - static_cast<float>(col));
  const auto along_y = cubic_weights(inside.y() - static_cast<float>(row));
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (int i = 0; i < 4; ++i) {
    const auto* pixels = image.ptr<cv::Vec3b>(std::clamp(row + i - 1, 0, image.rows - 1));
    for (int k = 0; k < 4; ++k) {
      const cv::Vec3b& bgr = pixels[std::clamp(col + k - 1, 0, image.cols - 1)];
      sum += along_y[static_cast<size_t>(i)] * along_x[static_cast<size_t>(k)] *
             Eigen::Vector3f(bgr[0], bgr[1], bgr[2]);
    }
  }
  return sum;
}

/// A view to take colours from.
struct SourceView {
  cv::Mat color;
  SE3 T_camera_world;
  Velocity velocity;
  Eigen::Vector3f gain_bgr;
};

/// Pixels that are coloured one by one.
struct LoosePixels {
  std::vector<cv::Point> pixels;
  std::vector<Eigen::Vector3f> points, normals;  // in the world
  std::vector<Rgb> vertex_colors;
};

class AtlasPainter {
 public:
  AtlasPainter(const AtlasContent& content, const DenseCamera& camera)
      : content_(content),
        camera_(camera),
        owners_(pixel_owners(content.layout)),
        sums_(content.layout.size, CV_16SC3, cv::Scalar::all(0)) {}

  /// Adds what a triangle takes from a view.
  void add(const Contribution& contribution, const SourceView& view) {
    const Triangle& corners = content_.mesh.triangles[contribution.triangle];
    Eigen::Matrix3d corners_camera;
    for (int k = 0; k < 3; ++k)
      corners_camera.col(k) =
          view.T_camera_world * content_.mesh.points[corners[static_cast<size_t>(k)]].cast<double>();
    const Barycentric shares(content_.layout, contribution.triangle);
    for_each_pixel(content_.layout, owners_, contribution.triangle, [&](int col, int row) {
      const Eigen::Vector3f inside = clamped(shares.at(static_cast<float>(col), static_cast<float>(row)));
      const float weight = contribution.share.dot(inside);
      if (weight == 0) return;
      const Eigen::Vector3f color =
          weight * color_at(col, row, shares, corners_camera, view) + contribution.offset_bgr * inside;
      add_to(col, row, color);
    });
  }

  /// The pixels of the triangles that no view sees as a whole.
  [[nodiscard]] LoosePixels loose_pixels() const {
    LoosePixels loose;
    const std::vector<Eigen::Vector3f> normals = vertex_normals(content_.mesh);
    for (uint32_t i = 0; i < content_.view_of_triangle.size(); ++i) {
      if (content_.view_of_triangle[i] != kNoView) continue;
      const Triangle& corners = content_.mesh.triangles[i];
      const auto mean = [&](const Eigen::Vector3f& shares, const std::vector<Eigen::Vector3f>& of) {
        return shares.x() * of[corners[0]] + shares.y() * of[corners[1]] + shares.z() * of[corners[2]];
      };
      const Barycentric shares(content_.layout, i);
      for_each_pixel(content_.layout, owners_, i, [&](int col, int row) {
        const Eigen::Vector3f inside = clamped(shares.at(static_cast<float>(col), static_cast<float>(row)));
        loose.pixels.emplace_back(col, row);
        loose.points.push_back(mean(inside, content_.mesh.points));
        loose.normals.push_back(mean(inside, normals).normalized());
        loose.vertex_colors.push_back(vertex_color(corners, inside));
      });
    }
    return loose;
  }

  /// Sets a pixel.
  void set(const cv::Point& pixel, const Rgb& color) {
    add_to(pixel.x, pixel.y, Eigen::Vector3f(color[2], color[1], color[0]));
  }

  /// The atlas, and which of its pixels were painted, 8UC1.
  [[nodiscard]] std::pair<cv::Mat, cv::Mat> result() const {
    cv::Mat image;
    sums_.convertTo(image, CV_8UC3, 1 / static_cast<double>(kStepsPerLevel));
    return {image, owners_ != kNobody};
  }

 private:
  /// Shares of the nearest place inside the triangle, approximately.
  static Eigen::Vector3f clamped(const Eigen::Vector3f& shares) {
    const Eigen::Vector3f inside = shares.cwiseMax(0);
    return inside / inside.sum();
  }

  /// The plane of a sliver is known only near it.
  static Eigen::Vector3f not_far_outside(const Eigen::Vector3f& shares) {
    constexpr float kFarthest = 2;
    return shares.cwiseAbs().maxCoeff() > kFarthest ? clamped(shares) : shares;
  }

  [[nodiscard]] Rgb vertex_color(const Triangle& corners, const Eigen::Vector3f& shares) const {
    Rgb mean{};
    for (size_t channel = 0; channel < mean.size(); ++channel) {
      float sum = 0.5F;  // rounds
      for (size_t k = 0; k < corners.size(); ++k)
        sum += shares(static_cast<int>(k)) * static_cast<float>(content_.mesh.colors[corners[k]][channel]);
      mean[channel] = static_cast<uint8_t>(sum);
    }
    return mean;
  }

  /// The colour in a view, averaged over the pixel where the atlas is coarser than the image.
  [[nodiscard]] Eigen::Vector3f color_at(int col, int row, const Barycentric& shares,
                                         const Eigen::Matrix3d& corners_camera,
                                         const SourceView& view) const {
    constexpr double kAlmostOne = 0.99;
    const int steps =
        content_.layout.scale > kAlmostOne ? 1 : static_cast<int>(std::ceil(1 / content_.layout.scale));
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (int i = 0; i < steps; ++i) {
      for (int k = 0; k < steps; ++k) {
        const auto offset = [&](int n) {
          return (static_cast<float>(n) + 0.5F) / static_cast<float>(steps) - 0.5F;
        };
        const Eigen::Vector3f at = not_far_outside(
            shares.at(static_cast<float>(col) + offset(k), static_cast<float>(row) + offset(i)));
        const Eigen::Vector3d p = corners_camera * at.cast<double>();
        sum += sample(view.color, camera_.raw_color_pixel(p, view.velocity).cast<float>());
      }
    }
    return sum.cwiseProduct(view.gain_bgr) / static_cast<float>(steps * steps);
  }

  void add_to(int col, int row, const Eigen::Vector3f& bgr) {
    auto& sum = sums_.at<cv::Vec3s>(row, col);
    for (int k = 0; k < 3; ++k)
      sum[k] = cv::saturate_cast<int16_t>(static_cast<float>(sum[k]) + kStepsPerLevel * bgr(k));
  }

  const AtlasContent& content_;
  const DenseCamera& camera_;
  cv::Mat owners_;
  cv::Mat sums_;  // times kStepsPerLevel
};

/// The contributions of the view that begin at `begin`.
std::span<const Contribution> of_one_view(const std::vector<Contribution>& all, size_t begin) {
  size_t end = begin;
  while (end < all.size() && all[end].view == all[begin].view) ++end;
  return std::span(all).subspan(begin, end - begin);
}

}  // namespace

cv::Mat paint_atlas(const AtlasContent& content, const StoredViews& stored, int threads,
                    const Progress& progress) {
  const std::span<const PosedImage> views = stored.views;
  AtlasPainter painter(content, stored.camera);
  const std::vector<Contribution> contributions = contributions_of(content);
  for (size_t begin = 0; begin < contributions.size();) {
    const auto part = of_one_view(contributions, begin);
    if (!report(progress, "painting", part.front().view, views.size())) break;
    const PosedImage& view = views[part.front().view];
    const SourceView source{stored.images.load(view.image).color, view.T_world_camera.inverse(),
                            view.velocity, view.color_gain.reverse()};
    // A pixel belongs to one triangle, which appears once in a view.
    parallel_for(part.size(), threads, [&](size_t first, size_t last) {
      for (size_t i = first; i < last; ++i) painter.add(part[i], source);
    });
    begin += part.size();
  }
  const LoosePixels loose = painter.loose_pixels();
  const auto colors = observed_colors(loose.points, loose.normals, stored, threads, progress);
  for (size_t i = 0; i < colors.size(); ++i)
    painter.set(loose.pixels[i], colors[i].value_or(loose.vertex_colors[i]));
  auto [image, painted] = painter.result();
  fill_gaps(image, painted);
  return image;
}

}  // namespace kinloop
