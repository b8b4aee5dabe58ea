#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/geometry/robust_loss.hpp"
#include "kinloop/optimize/bundle/bundle.hpp"
#include "kinloop/optimize/kernels/bundle_products.hpp"
#include "kinloop/optimize/kernels/gram.hpp"
#include "kinloop/optimize/pose/camera_observations.hpp"
#include "tests/optimize/synthetic_view.hpp"
#include "tests/support/random_vectors.hpp"
#include "tests/support/simd_targets.hpp"

namespace kinloop {
namespace {

using test::random_motion;
using test::random_vector;
using Lanes = ObservationBlock::Lanes;

constexpr size_t kSize = ObservationBlock::kSize;
constexpr double kRobustWidth = 0.5;
constexpr DepthNoise kDepthNoise = {6e-3, 0.8};

/// A sensor with every correction.
Sensor corrected_sensor() {
  Sensor sensor = test::kinect_sensor();
  sensor.noise.keypoint = kDepthNoise;
  sensor.noise.robust_width = kRobustWidth;
  sensor.corrections << 5, -3, 1, 2, 0.05, -0.03, 0.03, 0.015, 0.02, 0.01, 0.002, 0.001, -0.001, 0.003, 0.002,
      -0.002;
  return sensor;
}

/// A moving camera and eight points in front of it, with measurement noise. The fourth has no depth, the
/// sixth no depth gradient.
struct ObservedPoints {
  Sensor sensor = corrected_sensor();
  SE3 T_world_camera;
  Velocity velocity;
  std::vector<Eigen::Vector3d> p_world;
  std::vector<KeypointMeasurement> observations;
  ObservationBlock block;

  explicit ObservedPoints(uint64_t seed) {
    Random random(seed);
    T_world_camera = random_motion(random, 1, 1);
    velocity = {random_vector(random, 1), random_vector(random, 2)};
    for (size_t lane = 0; lane < kSize; ++lane) {
      const Eigen::Vector3d p = test::uniform_vector<3>(random, {-1, -1, 1}, {1, 1, 3});
      KeypointMeasurement o;
      o.pixel = sensor.camera.project(p) + test::uniform_vector<2>(random, {-3, -3}, {3, 3});
      o.depth_m = lane == 3 ? 0 : p.z() + random.uniform(-0.02, 0.02);
      o.sigma_px = random.uniform(1, 3);
      o.row = random.uniform(-0.5, 0.5);
      o.depth_stamp_difference_s = random.uniform(-0.02, 0.02);
      o.inverse_depth_gradient = {random.uniform(-2e-3, 2e-3), random.uniform(-2e-3, 2e-3)};
      if (lane == 5) o.inverse_depth_gradient.setConstant(test::kNan);
      observations.push_back(o);
      p_world.push_back(T_world_camera * p);
      place(lane, lane);
    }
  }

  /// Writes an observation to a lane of the block.
  void place(size_t observation, size_t lane) {
    set_measurement(block, lane, observations[observation]);
    block.x[lane] = p_world[observation].x();
    block.y[lane] = p_world[observation].y();
    block.z[lane] = p_world[observation].z();
    block.uses_pixel[lane] = 1;
    block.uses_depth[lane] = block.inverse_depth_per_m[lane] > 0 ? 1 : 0;
  }

  [[nodiscard]] BundleView view() const { return {T_world_camera, velocity}; }
};

/// A linearised block with all derivatives.
struct Linear {
  LinearColumns layout = LinearColumns::of_all();
  std::vector<double> columns = std::vector<double>(kSize * kRowsPerObservation * layout.width);
  Lanes cost{};

  explicit Linear(const ObservedPoints& scene) {
    cost = linearize_block(scene.block, scene.view(), scene.sensor, layout, columns.data());
  }
  [[nodiscard]] double at(size_t lane, size_t row, size_t column) const {
    return columns[(row * layout.width + column) * kSize + lane];
  }
  [[nodiscard]] std::vector<double> row(size_t lane, size_t row) const {
    std::vector<double> values;
    for (size_t column = 0; column < layout.width; ++column) values.push_back(at(lane, row, column));
    return values;
  }
  /// Returns all outputs for one observation.
  [[nodiscard]] std::vector<double> numbers(size_t lane) const {
    std::vector<double> all;
    for (size_t i = 0; i < kRowsPerObservation; ++i) {
      const auto values = row(lane, i);
      all.insert(all.end(), values.begin(), values.end());
    }
    all.push_back(cost[lane]);
    return all;
  }
};

TEST(ObservationBlock, ResidualsMatchTheSensorModel) {
  const ObservedPoints scene(1);
  const BlockResiduals r = block_residuals(scene.block, scene.view(), scene.sensor);
  const SensorVector& s = scene.sensor.corrections;
  for (size_t lane = 0; lane < kSize; ++lane) {
    const KeypointMeasurement& o = scene.observations[lane];
    const Eigen::Vector3d p = scene.T_world_camera.inverse() * scene.p_world[lane];
    const auto seen_at = [&](double time_s) { return point_in_later_camera(p, scene.velocity, time_s); };
    const auto pixel_of = [&](const Eigen::Vector3d& q) {
      return corrected_pixel(scene.sensor, q.head<2>() / q.z());
    };
    const double color_s = s(kRollingShutter) * o.row;
    const Eigen::Vector2d error = (pixel_of(seen_at(color_s)) - o.pixel) / o.sigma_px;
    EXPECT_NEAR(r.u[lane], error.x(), 1e-9);
    EXPECT_NEAR(r.v[lane], error.y(), 1e-9);
    EXPECT_EQ(r.seen[lane], 1);
    if (o.depth_m == 0) {
      EXPECT_EQ(r.depth[lane], 0);
      continue;
    }
    const bool has_slope = o.inverse_depth_gradient.allFinite();
    const Eigen::Vector3d q =
        seen_at(has_slope ? o.depth_stamp_difference_s + s(kDepthDelay) + s(kDepthShutter) * o.row : color_s);
    double depth_error =
        (1 + s(kDepthScale)) / o.depth_m - 1 / q.z() +
        s.segment<6>(kInverseDepthBias).dot(inverse_depth_bias_basis(scene.sensor.camera, o.pixel));
    if (has_slope) depth_error += o.inverse_depth_gradient.dot(pixel_of(q) - o.pixel);
    EXPECT_NEAR(r.depth[lane], depth_error / kDepthNoise.inverse_sigma_per_m(1 / o.depth_m), 1e-9);
  }
}

TEST(ObservationBlock, RowsHoldTheWeightedResiduals) {
  const ObservedPoints scene(2);
  const Linear linear(scene);
  const BlockResiduals r = block_residuals(scene.block, scene.view(), scene.sensor);
  const Lanes cost = block_cost(scene.block, scene.view(), scene.sensor);
  const HuberLoss loss{kRobustWidth};
  for (size_t lane = 0; lane < kSize; ++lane) {
    const double pixel = r.u[lane] * r.u[lane] + r.v[lane] * r.v[lane];
    const double depth = r.depth[lane] * r.depth[lane];
    EXPECT_NEAR(linear.cost[lane], loss.rho(pixel) + loss.rho(depth), 1e-9);
    EXPECT_EQ(linear.cost[lane], cost[lane]);
    const auto residual = [&](size_t row) { return linear.at(lane, row, LinearColumns::kResidual); };
    EXPECT_NEAR(residual(0), std::sqrt(loss.weight(pixel)) * r.u[lane], 1e-12);
    EXPECT_NEAR(residual(1), std::sqrt(loss.weight(pixel)) * r.v[lane], 1e-12);
    EXPECT_NEAR(residual(2), std::sqrt(loss.weight(depth)) * r.depth[lane], 1e-12);
  }
}

TEST(ObservationBlock, LaneOrderDoesNotMatter) {
  ObservedPoints scene(3);
  const Linear before(scene);
  for (size_t lane = 0; lane < kSize; ++lane) scene.place(kSize - 1 - lane, lane);
  const Linear turned(scene);
  for (size_t lane = 0; lane < kSize; ++lane) {
    EXPECT_EQ(turned.numbers(lane), before.numbers(kSize - 1 - lane));
  }
}

TEST(ObservationBlock, UnusedObservationsAreIgnored) {
  ObservedPoints scene(4);
  scene.block.uses_pixel[2] = scene.block.uses_depth[2] = 0;
  scene.block.uses_depth[4] = 0;
  scene.block.x[6] = scene.block.y[6] = scene.block.z[6] = 0;  // an empty lane
  scene.block.inverse_sigma_px[6] = scene.block.uses_pixel[6] = scene.block.uses_depth[6] = 0;
  const Linear linear(scene);
  EXPECT_THAT(linear.numbers(2), testing::Each(0));
  EXPECT_THAT(linear.numbers(6), testing::Each(0));
  EXPECT_THAT(linear.row(4, 2), testing::Each(0));
  EXPECT_GT(linear.cost[4], 0);
}

TEST(ObservationBlock, APointBehindTheCameraHasZeroGradient) {
  ObservedPoints scene(5);
  scene.p_world[1] = scene.T_world_camera * Eigen::Vector3d(0.1, 0.1, -1);
  scene.place(1, 1);
  const Linear linear(scene);
  EXPECT_EQ(block_residuals(scene.block, scene.view(), scene.sensor).seen[1], 0);
  EXPECT_EQ(linear.cost[1], HuberLoss{kRobustWidth}.rho(kBehindCameraSquared));
  auto numbers = linear.numbers(1);
  numbers.pop_back();  // the cost
  EXPECT_THAT(numbers, testing::Each(0));
}

TEST(ObservationBlock, InstructionSetsGiveIdenticalBits) {
  const ObservedPoints scene(6);
  const Linear expected(scene);
  const BlockResiduals residuals = block_residuals(scene.block, scene.view(), scene.sensor);
  test::for_each_simd_target([&](const std::string& name) {
    const Linear linear(scene);
    EXPECT_EQ(linear.columns, expected.columns) << name;
    EXPECT_EQ(linear.cost, expected.cost) << name;
    const BlockResiduals r = block_residuals(scene.block, scene.view(), scene.sensor);
    EXPECT_EQ(r.u, residuals.u) << name;
    EXPECT_EQ(r.v, residuals.v) << name;
    EXPECT_EQ(r.depth, residuals.depth) << name;
  });
}

/// A linearised block with some free sensor parameters, in columns.
struct LinearBundle {
  LinearColumns layout;
  std::vector<double> columns;

  explicit LinearBundle(const ObservedPoints& scene) : layout(LinearColumns::of_bundle(free_parameters())) {
    columns.resize(kRowsPerObservation * layout.width * kSize);
    linearize_block(scene.block, scene.view(), scene.sensor, layout, columns.data());
  }
  static SensorVector free_parameters() {
    SensorVector sigma = SensorVector::Zero();
    sigma(kFocalY) = sigma(kRollingShutter) = sigma(kDepthDelay) = sigma(kInverseDepthBiasXY) = 1;
    return sigma;
  }
  [[nodiscard]] Eigen::MatrixXd gram() const {
    const GramColumns summed(layout);
    std::vector<double> sums(summed.sums(), 0);
    add_block_gram(summed, columns.data(), sums.data());
    return gram_of_sums(summed, sums).triangularView<Eigen::Upper>();
  }
  /// Point products of all observations.
  [[nodiscard]] std::vector<double> products() const {
    const PointProducts sizes(layout);
    std::vector<double> records(kSize * sizes.size());
    std::array<double*, kSize> targets;
    for (size_t lane = 0; lane < kSize; ++lane) targets[lane] = &records[lane * sizes.size()];
    write_point_products(layout, columns.data(), targets);
    return records;
  }
  [[nodiscard]] Eigen::MatrixXd J(size_t lane) const {
    const auto width = static_cast<Eigen::Index>(layout.width);
    Eigen::MatrixXd rows(3, width);
    for (Eigen::Index i = 0; i < 3; ++i)
      for (Eigen::Index j = 0; j < width; ++j)
        rows(i, j) = columns[static_cast<size_t>(i * width + j) * kSize + lane];
    return rows;
  }
};

TEST(LinearColumns, OfBundleHoldTheFreeSensorParameters) {
  const ObservedPoints scene(7);
  const Linear all(scene);
  const LinearBundle bundle(scene);
  for (size_t lane = 0; lane < kSize; ++lane) {
    const Eigen::MatrixXd J = bundle.J(lane);
    for (size_t row = 0; row < kRowsPerObservation; ++row) {
      const auto i = static_cast<Eigen::Index>(row);
      for (size_t c = 0; c <= LinearColumns::kResidual; ++c) {
        EXPECT_EQ(J(i, static_cast<Eigen::Index>(c)), all.at(lane, row, c));
      }
      for (size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(J(i, static_cast<Eigen::Index>(*bundle.layout.point + c)),
                  all.at(lane, row, *all.layout.point + c));
      }
      for (const size_t k : {kFocalY, kRollingShutter, kDepthDelay, kInverseDepthBiasXY}) {
        EXPECT_EQ(J(i, bundle.layout.of_sensor[k]),
                  all.at(lane, row, static_cast<size_t>(all.layout.of_sensor[k])));
      }
    }
  }
}

TEST(LinearColumns, GramAndPointProductsMatchDenseProducts) {
  const LinearBundle bundle(ObservedPoints(8));
  const auto used = static_cast<Eigen::Index>(bundle.layout.used);
  const PointProducts sizes(bundle.layout);
  const auto records = bundle.products();
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(used, used);
  for (size_t lane = 0; lane < kSize; ++lane) {
    const Eigen::MatrixXd J = bundle.J(lane), J_point = J.rightCols(3);
    gram += J.leftCols(used).transpose() * J.leftCols(used);
    const double* record = &records[lane * sizes.size()];
    const Eigen::MatrixXd W = J_point.transpose() * J.leftCols(6),
                          C = J_point.transpose() * J.middleCols(6, used - 6);
    const Eigen::MatrixXd H = J_point.transpose() * J_point;
    const Eigen::Map<const Eigen::Matrix<double, 3, 6, Eigen::RowMajor>> pose(record);
    EXPECT_LT((pose - W).norm(), 1e-12 * W.norm());
    for (Eigen::Index i = 0; i < 3; ++i)
      for (Eigen::Index c = 0; c < C.cols(); ++c)
        EXPECT_NEAR(record[PointProducts::kPose + static_cast<size_t>(i * C.cols() + c)], C(i, c),
                    1e-12 * C.norm());
    const double* upper = record + sizes.size() - 6;
    for (Eigen::Index i = 0; i < 3; ++i)
      for (Eigen::Index j = i; j < 3; ++j) EXPECT_NEAR(*upper++, H(i, j), 1e-12 * H.norm());
  }
  const Eigen::MatrixXd expected = gram.triangularView<Eigen::Upper>();
  EXPECT_LT((bundle.gram() - expected).norm(), 1e-12 * expected.norm());
}

TEST(PointFactor, EliminatesAPoint) {
  const LinearBundle bundle(ObservedPoints(9));
  const PointProducts sizes(bundle.layout);
  const auto records = bundle.products();
  Eigen::Matrix3d H;
  H << 5, 1, -2, 1, 4, 0.5, -2, 0.5, 6;
  std::vector<double> U(2 * kEliminatedSize);
  eliminate_point(PointFactor({5, 1, -2, 4, 0.5, 6}), records.data(), sizes.size(), 2, U.data());
  using Pose = Eigen::Map<const Eigen::Matrix<double, 3, 6, Eigen::RowMajor>>;
  using Eliminated = Eigen::Map<const Eigen::Matrix<double, 3, 6, Eigen::RowMajor>, 0, Eigen::OuterStride<>>;
  const Pose W0(&records[0]), W1(&records[sizes.size()]);
  const Eliminated U0(&U[0], Eigen::OuterStride<>(8)), U1(&U[kEliminatedSize], Eigen::OuterStride<>(8));
  const Eigen::MatrixXd expected = W0.transpose() * H.inverse() * W1;
  EXPECT_LT((U0.transpose() * U1 - expected).norm(), 1e-10 * expected.norm());
  const PointFactor singular({1, 1, 0, 1, 0, 1});
  EXPECT_EQ(singular.i00 + singular.i11 + singular.i22, 0);
}

TEST(LinearColumns, InstructionSetsGiveIdenticalBits) {
  const ObservedPoints scene(10);
  const LinearBundle expected(scene);
  test::for_each_simd_target(
      [&, products = expected.products(), gram = expected.gram()](const std::string& name) {
        const LinearBundle bundle(scene);
        EXPECT_EQ(bundle.columns, expected.columns) << name;
        EXPECT_EQ(bundle.products(), products) << name;
        EXPECT_EQ(bundle.gram(), gram) << name;
      });
}

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

RowMajorMatrix random_matrix(Eigen::Index rows, Eigen::Index columns, uint64_t seed) {
  Random random(seed);
  return RowMajorMatrix::NullaryExpr(rows, columns, [&] { return random.gaussian(); });
}

RowMajorMatrix gram_of(const RowMajorMatrix& J) {
  RowMajorMatrix gram = RowMajorMatrix::Zero(J.cols(), J.cols());
  add_gram(J.data(), static_cast<size_t>(J.rows()), static_cast<size_t>(J.cols()), gram.data());
  return gram.triangularView<Eigen::Upper>();
}

TEST(Gram, IsTheProductOfTheColumns) {
  for (Eigen::Index width = kWidthStep; width <= static_cast<Eigen::Index>(kMaxGramWidth);
       width += kWidthStep) {
    const RowMajorMatrix J = random_matrix(41, width, 7);
    const RowMajorMatrix expected = (J.transpose() * J).eval().triangularView<Eigen::Upper>();
    EXPECT_LT((gram_of(J) - expected).norm(), 1e-12 * expected.norm());
    test::for_each_simd_target(
        [&, same = gram_of(J)](const std::string& name) { EXPECT_EQ(gram_of(J), same) << name; });
  }
}

TEST(Gram, AccumulatesIntoTheResult) {
  const RowMajorMatrix J = random_matrix(10, 8, 8);
  RowMajorMatrix twice = RowMajorMatrix::Zero(8, 8);
  for (int i = 0; i < 2; ++i) add_gram(J.data(), 10, 8, twice.data());
  EXPECT_LT((RowMajorMatrix(twice.triangularView<Eigen::Upper>()) - 2 * gram_of(J)).norm(), 1e-12);
}

TEST(Gram, RejectsUnsupportedWidths) {
  double values[40] = {};
  EXPECT_THROW(add_gram(values, 0, 0, values), std::logic_error);
  EXPECT_THROW(add_gram(values, 1, 12, values), std::logic_error);
  EXPECT_THROW(add_gram(values, 1, 40, values), std::logic_error);
}

}  // namespace
}  // namespace kinloop
