#include "kinloop/dense/texture/paint_atlas.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/dense/cloud/point_colors.hpp"

namespace kinloop {
namespace {

constexpr int32_t kNobody = -1;

/// Fixed point of colours while contributions are added; offsets may exceed the range of a byte.
constexpr float kStepsPerLevel = 64;

/// Shares of the corners of a triangle at a place of its plane in the atlas; outside the triangle some are
/// negative.
class Barycentric {
 public:
  Barycentric(const AtlasLayout& layout, uint32_t triangle) {
    const auto& [a, b, c] = layout.triangles[triangle];
    a_ = layout.corners_px[a];
    const Eigen::Vector2f ab = layout.corners_px[b] - a_, ac = layout.corners_px[c] - a_;
    const float area = ab.x() * ac.y() - ab.y() * ac.x();
    if (area == 0) return;  // everything is the first corner
    to_b_ = Eigen::Vector2f(ac.y(), -ac.x()) / area;
    to_c_ = Eigen::Vector2f(-ab.y(), ab.x()) / area;
  }

  [[nodiscard]] Eigen::Vector3f at(float col, float row) const {
    const Eigen::Vector2f from_a = Eigen::Vector2f(col, row) - a_;
    const float b = to_b_.dot(from_a), c = to_c_.dot(from_a);
    return {1 - b - c, b, c};
  }

 private:
  Eigen::Vector2f a_, to_b_ = Eigen::Vector2f::Zero(), to_c_ = Eigen::Vector2f::Zero();
};

/// The pixels around a triangle.
cv::Rect box_of(const AtlasLayout& layout, uint32_t triangle, int margin_px) {
  Eigen::Array2f low = layout.corners_px[layout.triangles[triangle][0]], high = low;
  for (const uint32_t corner : layout.triangles[triangle]) {
    low = low.min(layout.corners_px[corner].array());
    high = high.max(layout.corners_px[corner].array());
  }
  const Eigen::Array2i first = low.floor().cast<int>() - margin_px,
                       last = high.ceil().cast<int>() + margin_px;
  return cv::Rect(cv::Point(first.x(), first.y()), cv::Point(last.x() + 1, last.y() + 1)) &
         cv::Rect({}, layout.size);
}

/// Calls `use(col, row)` for the pixels around the triangle that belong to it.
template <class Use>
void for_each_pixel(const AtlasLayout& layout, const cv::Mat& owners, uint32_t triangle, const Use& use) {
  const cv::Rect box = box_of(layout, triangle, kAtlasMarginPx);
  for (int row = box.y; row < box.br().y; ++row) {
    const auto* owner = owners.ptr<int32_t>(row);
    for (int col = box.x; col < box.br().x; ++col) {
      if (owner[col] == static_cast<int32_t>(triangle)) use(col, row);
    }
  }
}

/// Gives pixels without an owner one of a neighbour.
void grow(cv::Mat& owners) {
  const cv::Mat before = owners.clone();
  for (int row = 0; row < owners.rows; ++row) {
    for (int col = 0; col < owners.cols; ++col) {
      auto& owner = owners.at<int32_t>(row, col);
      if (owner != kNobody) continue;
      for (const auto& [down, right] :
           {std::pair(0, -1), std::pair(0, 1), std::pair(-1, 0), std::pair(1, 0)}) {
        const int r = row + down, c = col + right;
        if (r < 0 || c < 0 || r >= owners.rows || c >= owners.cols) continue;
        owner = std::max(owner, before.at<int32_t>(r, c));
      }
    }
  }
}

/// The triangle of each pixel, 32SC1: the one that covers it, else one within the margin.
cv::Mat owners_of(const AtlasLayout& layout) {
  constexpr float kRounding = -1e-4F;
  cv::Mat owners(layout.size, CV_32SC1, cv::Scalar(kNobody));
  for (uint32_t i = 0; i < layout.triangles.size(); ++i) {
    const Barycentric shares(layout, i);
    const cv::Rect box = box_of(layout, i, 0);
    for (int row = box.y; row < box.br().y; ++row) {
      for (int col = box.x; col < box.br().x; ++col) {
        auto& owner = owners.at<int32_t>(row, col);
        const bool inside =
            shares.at(static_cast<float>(col), static_cast<float>(row)).minCoeff() >= kRounding;
        if (owner == kNobody && inside) owner = static_cast<int32_t>(i);
      }
    }
  }
  for (int i = 0; i < kAtlasMarginPx; ++i) grow(owners);
  return owners;
}

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
        owners_(owners_of(content.layout)),
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
        const Eigen::Vector3d p =
            corners_camera *
            shares.at(static_cast<float>(col) + offset(k), static_cast<float>(row) + offset(i))
                .cast<double>();
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

/// Fills what is not painted with the mean colour around it, from the nearest on (push and pull, Gortler et
/// al. 1996), so that smaller versions of the atlas show no seams.
void fill_gaps(cv::Mat& image, const cv::Mat& painted) {
  const double share = cv::mean(painted)[0];
  if (share == 0 || std::min(image.cols, image.rows) <= 1) return;
  image.setTo(cv::Scalar::all(0), painted == 0);
  const cv::Size half((image.cols + 1) / 2, (image.rows + 1) / 2);
  cv::Mat small, weight;
  cv::resize(image, small, half, 0, 0, cv::INTER_AREA);
  cv::resize(painted, weight, half, 0, 0, cv::INTER_AREA);
  for (int row = 0; row < half.height; ++row) {
    for (int col = 0; col < half.width; ++col) {
      const int w = weight.at<uint8_t>(row, col);
      if (w == 0) continue;
      for (int k = 0; k < 3; ++k) {
        auto& value = small.at<cv::Vec3b>(row, col)[k];
        value = cv::saturate_cast<uint8_t>(value * 255 / w);
      }
    }
  }
  const cv::Mat known = weight > 0;
  fill_gaps(small, known);
  cv::Mat filling;
  cv::resize(small, filling, image.size(), 0, 0, cv::INTER_LINEAR);
  filling.copyTo(image, painted == 0);
}

/// The contributions of the view that begin at `begin`.
std::span<const Contribution> of_one_view(const std::vector<Contribution>& all, size_t begin) {
  size_t end = begin;
  while (end < all.size() && all[end].view == all[begin].view) ++end;
  return std::span(all).subspan(begin, end - begin);
}

}  // namespace

cv::Mat paint_atlas(const AtlasContent& content, const ImageStore& images, std::span<const PosedImage> views,
                    const DenseCamera& camera, int threads, const Progress& progress) {
  AtlasPainter painter(content, camera);
  const std::vector<Contribution> contributions = contributions_of(content);
  for (size_t begin = 0; begin < contributions.size();) {
    const auto part = of_one_view(contributions, begin);
    if (!report(progress, "painting", part.front().view, views.size())) break;
    const PosedImage& view = views[part.front().view];
    const SourceView source{images.load(view.image).color, view.T_world_camera.inverse(), view.velocity,
                            view.color_gain.reverse()};
    // A pixel belongs to one triangle, which appears once in a view.
    parallel_for(part.size(), threads, [&](size_t first, size_t last) {
      for (size_t i = first; i < last; ++i) painter.add(part[i], source);
    });
    begin += part.size();
  }
  const LoosePixels loose = painter.loose_pixels();
  const auto colors = observed_colors(loose.points, loose.normals, images, views, camera, threads, progress);
  for (size_t i = 0; i < colors.size(); ++i)
    painter.set(loose.pixels[i], colors[i].value_or(loose.vertex_colors[i]));
  auto [image, painted] = painter.result();
  fill_gaps(image, painted);
  return image;
}

}  // namespace kinloop
