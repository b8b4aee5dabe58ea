#pragma once
// Products of the derivatives of bundle adjustment, and the elimination of its points. Bitwise identical on
// every instruction set.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "kinloop/optimize/kernels/observation_block.hpp"

namespace kinloop {

/// Products of one observation with its own point: W[i][c] (point axis i, pose axis c), then for each point
/// axis those with the residual and the sensor, then the upper triangle of the point block.
struct PointProducts {
  static constexpr size_t kPose = 18;  ///< values of W

  explicit PointProducts(const LinearColumns& columns) : border(1 + columns.sensor_count) {}

  size_t border;  ///< residual and free sensor parameters

  [[nodiscard]] size_t sums() const { return 3 * border + 6; }  ///< values to be summed over a point
  [[nodiscard]] size_t size() const { return kPose + sums(); }
};

/// Columns of a linearised block, and those whose products are summed.
struct GramColumns {
  size_t count = 0;      ///< the first ones
  size_t pixel_end = 0;  ///< from here on, only the depth row is not zero
  size_t width = 0;      ///< all columns, at least `count` rounded up to four

  explicit GramColumns(const LinearColumns& all)
      : count(all.used), pixel_end(all.pixel_end), width(all.width) {}

  /// Number of values of the sums. Rows are computed in groups.
  [[nodiscard]] size_t sums() const { return (count + 3) * count * ObservationBlock::kSize; }
};

/// Adds J'J of a block to `sums`, an array [row][column][observation], of which the upper triangle is
/// defined.
void add_block_gram(const GramColumns& layout, const double* columns, double* sums);

/// Returns J'J given the sums; the upper triangle is defined.
Eigen::MatrixXd gram_of_sums(const GramColumns& layout, std::span<const double> sums);

/// Writes the PointProducts of each observation of a block.
void write_point_products(const LinearColumns& layout, const double* columns,
                          const std::array<double*, ObservationBlock::kSize>& records);

/// Inverse Cholesky factor of a 3 x 3 matrix H = L L'; zero if H is singular.
struct PointFactor {
  double l10 = 0, l20 = 0, l21 = 0;  ///< of L
  double i00 = 0, i11 = 0, i22 = 0;  ///< 1 / diagonal of L

  PointFactor() = default;
  /// The upper triangle, row by row.
  explicit PointFactor(const std::array<double, 6>& H);
};

constexpr size_t kEliminatedWidth = 8;  ///< values of a point axis: six of the pose and padding
constexpr size_t kEliminatedSize = 3 * kEliminatedWidth;

/// Writes U = L^-1 W, of kEliminatedSize values, for `count` consecutive records.
void eliminate_point(const PointFactor& factor, const double* records, size_t record_size, size_t count,
                     double* U);

/// The observations of one camera whose points are eliminated. The observations of a point are consecutive
/// and sorted by camera.
struct SchurColumn {
  struct Slot {
    uint32_t own = 0;              ///< index of the observation
    uint32_t first = 0, last = 0;  ///< observations of its point by this and later cameras
    uint32_t point = 0;
  };
  std::span<const Slot> slots;
  std::span<const uint32_t> block_of_camera;  ///< index of its block in this column
  const int* camera_of_slot = nullptr;
  const double* U = nullptr;       ///< per observation, see eliminate_point
  const double* border = nullptr;  ///< per point [axis][border]: L^-1 of residual and sensor
  size_t border_count = 0;
  size_t border_stride = 0;  ///< of `border` from axis to axis
};

constexpr size_t kSchurBlockSize = 6 * kEliminatedWidth;

/// Adds U' U to `blocks` ([block][own axis][axis of the other camera]) and U' border to `right`
/// ([border][own axis]). The last index runs over kEliminatedWidth values, of which six are defined.
void add_schur_column(const SchurColumn& column, double* blocks, double* right);

}  // namespace kinloop
