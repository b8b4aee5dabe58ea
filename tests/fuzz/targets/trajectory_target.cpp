#include "kinloop/geometry/trajectory.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"
#include "tools/evaluation/evaluate.hpp"
#include "tools/evaluation/trajectory_files/trajectory_file.hpp"

namespace kinloop::fuzz {

namespace {

void use(const Trajectory& trajectory) {
  for (const StampedPose& pose : trajectory) require(pose.T_world_camera.is_finite(), "a pose not finite");
  static_cast<void>(evaluate(trajectory, trajectory));
}

}  // namespace

void read_trajectory_bytes(std::string_view bytes) {
  with_file("trajectory.txt", bytes, [](const auto& path) {
    accept([&] { use(read_tum_trajectory(path)); });
    accept([&] { use(read_trajectory_file(path).poses); });
  });
}

}  // namespace kinloop::fuzz
