#include "kinloop/io/covariance_file.hpp"

#include <limits>

#include <fmt/ostream.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/map/frames/pose_covariance.hpp"

namespace kinloop {

void write_covariances(const std::filesystem::path& path, const Trajectory& trajectory,
                       const TrajectoryCovariances& covariances) {
  require(covariances.size() == trajectory.size(), "write_covariances: one covariance for each pose");
  constexpr const char* kHeader =
      "# stamp_s, then 21 values: the upper triangle, row by row, of the covariance of (x y z; rotation "
      "about x y z) "
      "in the axes of the camera, m and rad, for each pose of trajectory.txt; nan: unknown\n";
  const Matrix6d unknown = Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN());
  AtomicFile file(path);
  fmt::print(file.stream(), "{}", kHeader);
  for (size_t i = 0; i < trajectory.size(); ++i) {
    fmt::print(file.stream(), "{}", format_stamp(trajectory[i].stamp_ns));
    for (const double value : upper_triangle(covariances[i].value_or(unknown)))
      fmt::print(file.stream(), " {:.9g}", value);
    fmt::print(file.stream(), "\n");
  }
  file.commit();
}

}  // namespace kinloop
