#include "dense/cloud/color_gains.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "dense/surfels/voxel_samples.hpp"
#include "kinloop/core/threads/parallel_for.hpp"

namespace kinloop {
namespace {

/// Size of the voxels in which views are compared: large enough to hold several points of each view.
constexpr double kVoxel_m = 0.03;

/// Sample sizes per view and in total.
constexpr size_t kPointsPerView = 5000, kPointsInAll = 300'000;

/// Standard deviations of log colour: between views of a voxel, and of the prior on gains (weak: a factor of
/// 1.6).
constexpr double kColorSigma = 0.1, kGainSigma = 0.5;

/// Mean colour of one voxel in one view.
struct ColorObservation {
  VoxelKey voxel = 0;
  uint32_t view = 0;
  float count = 0;
  Eigen::Array3f log_color = Eigen::Array3f::Zero();
};

/// One column per view: the logarithms of its gains.
using LogGains = Eigen::Array3Xd;

bool precedes(const ColorObservation& a, const ColorObservation& b) {
  return std::tie(a.voxel, a.view) < std::tie(b.voxel, b.view);
}

/// Merges the observations of each voxel by the same view; they must be adjacent.
std::vector<ColorObservation> merged(const std::vector<ColorObservation>& all) {
  std::vector<ColorObservation> means;
  for (const ColorObservation& seen : all) {
    if (means.empty() || means.back().voxel != seen.voxel || means.back().view != seen.view) {
      means.push_back(seen);
      continue;
    }
    means.back().log_color += seen.log_color;
    means.back().count += seen.count;
  }
  for (ColorObservation& mean : means) mean.log_color /= mean.count;
  return means;
}

/// The observations of one view by voxel; subsampled by voxel if there are many views.
std::vector<ColorObservation> observe(const ImageSurfels& surfels, uint32_t number, const PosedImage& view,
                                      const DenseCamera& camera, const RayTable& rays,
                                      uint64_t last_scattered) {
  ImageSurfels some = thinned(surfels, kPointsPerView);
  std::erase_if(some.points, [](const Surfel& point) { return !is_well_exposed(point.color); });
  std::vector<ColorObservation> seen;
  for (const VoxelSample& sample : voxel_samples(some, view, camera, rays, kVoxel_m)) {
    if (hash_key(sample.key) > last_scattered) continue;
    const Eigen::Array3f color(sample.color[0], sample.color[1], sample.color[2]);
    seen.push_back({sample.key, number, 1, color.log()});
  }
  std::sort(seen.begin(), seen.end(), precedes);
  return merged(seen);
}

/// Least squares over g_i and a_v of log color_iv + g_i - a_v, where view i saw voxel v, with Cauchy weights;
/// a_v, the voxel's own log colour, is eliminated.
class GainSolver {
 public:
  GainSolver(std::vector<ColorObservation> seen, size_t views)
      : seen_(std::move(seen)), weights_(seen_.size(), 1.0), gains_(LogGains::Zero(3, Eigen::Index(views))) {}

  LogGains run() {
    constexpr int kReweightings = 4;
    for (int pass = 0; pass < kReweightings; ++pass) {
      solve();
      reweight();
    }
    return gains_;
  }

 private:
  /// Calls `use` with the range of observations of each voxel that several views saw.
  template <class Use>
  void for_each_voxel(const Use& use) const {
    for (size_t begin = 0; begin < seen_.size();) {
      size_t end = begin;
      while (end < seen_.size() && seen_[end].voxel == seen_[begin].voxel) ++end;
      if (end - begin > 1) use(begin, end);
      begin = end;
    }
  }

  /// Per view, the weighted sum of the differences between `value(i)` and the weighted mean of its voxel.
  template <class Value>
  [[nodiscard]] LogGains above_mean(const Value& value) const {
    LogGains sums = LogGains::Zero(3, gains_.cols());
    for_each_voxel([&](size_t begin, size_t end) {
      Eigen::Array3d mean = Eigen::Array3d::Zero();
      double weight = 0;
      for (size_t i = begin; i < end; ++i) mean += weights_[i] * value(i), weight += weights_[i];
      mean /= weight;
      for (size_t i = begin; i < end; ++i) sums.col(seen_[i].view) += weights_[i] * (value(i) - mean);
    });
    return sums;
  }

  /// The matrix of the normal equations times `x`; the same for each colour channel.
  [[nodiscard]] LogGains times(const LogGains& x) const {
    constexpr double kPrior = (kColorSigma / kGainSigma) * (kColorSigma / kGainSigma);
    return above_mean([&](size_t i) -> Eigen::Array3d { return x.col(seen_[i].view); }) + kPrior * x;
  }

  /// Conjugate gradients for all three channels at once, starting from the current gains.
  void solve() {
    constexpr int kMaxSteps = 50;
    constexpr double kEnough = 1e-6;  // relative to the first residual, squared
    const LogGains right =
        -above_mean([&](size_t i) -> Eigen::Array3d { return seen_[i].log_color.cast<double>(); });
    LogGains residual = right - times(gains_);
    LogGains direction = residual;
    Eigen::Array3d norm = residual.square().rowwise().sum();
    const Eigen::Array3d enough = kEnough * right.square().rowwise().sum();
    for (int step = 0; step < kMaxSteps && (norm > enough).any(); ++step) {
      const LogGains product = times(direction);
      const Eigen::Array3d along = (direction * product).rowwise().sum();
      const Eigen::Array3d length = (along > 0).select(norm / along, 0);
      gains_ += direction.colwise() * length;
      residual -= product.colwise() * length;
      const Eigen::Array3d next = residual.square().rowwise().sum();
      direction = residual + direction.colwise() * (norm > 0).select(next / norm, 0);
      norm = next;
    }
  }

  void reweight() {
    for_each_voxel([&](size_t begin, size_t end) {
      const auto apply_gain = [&](size_t i) -> Eigen::Array3d {
        return seen_[i].log_color.cast<double>() + gains_.col(seen_[i].view);
      };
      Eigen::Array3d mean = Eigen::Array3d::Zero();
      double weight = 0;
      for (size_t i = begin; i < end; ++i) mean += weights_[i] * apply_gain(i), weight += weights_[i];
      mean /= weight;
      for (size_t i = begin; i < end; ++i) {
        const double error = (apply_gain(i) - mean).square().sum() / 3;
        weights_[i] = 1 / (1 + error / (kColorSigma * kColorSigma));
      }
    });
  }

  std::vector<ColorObservation> seen_;
  std::vector<double> weights_;
  LogGains gains_;
};

std::vector<ColorObservation> observe_all(const SurfelLoader& load_surfels, std::span<const PosedImage> views,
                                          const DenseCamera& camera, int threads) {
  const RayTable rays = ray_table(camera.color, threads);
  const double share =
      std::min(1.0, static_cast<double>(kPointsInAll) / static_cast<double>(views.size() * kPointsPerView));
  constexpr double kScatteredRange = 0x1p64;
  const auto last_scattered = share < 1 ? static_cast<uint64_t>(share * kScatteredRange) : ~uint64_t{0};
  std::vector<std::vector<ColorObservation>> parts(views.size());
  parallel_for(views.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      parts[i] = observe(load_surfels(views[i].image), static_cast<uint32_t>(i), views[i], camera, rays,
                         last_scattered);
    }
  });
  std::vector<ColorObservation> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  std::sort(all.begin(), all.end(), precedes);
  return all;
}

}  // namespace

bool is_well_exposed(const Rgb& color) {
  constexpr uint8_t kDarkest = 50, kBrightest = 245;
  const auto [least, most] = std::minmax_element(color.begin(), color.end());
  return *least >= kDarkest && *most <= kBrightest;
}

std::vector<Eigen::Vector3f> color_gains(const SurfelLoader& load_surfels, std::span<const PosedImage> views,
                                         const DenseCamera& camera, int threads) {
  if (views.empty()) return {};
  LogGains gains = GainSolver(observe_all(load_surfels, views, camera, threads), views.size()).run();
  gains.colwise() -= gains.rowwise().mean().eval();
  std::vector<Eigen::Vector3f> factors;
  for (Eigen::Index i = 0; i < gains.cols(); ++i) {
    factors.emplace_back(gains.col(i).exp().matrix().cast<float>());
  }
  return factors;
}

}  // namespace kinloop
