#include "kinloop/geometry/trajectory.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop::fuzz {

void read_trajectory_bytes(std::string_view bytes) {
  with_file("trajectory.txt", bytes, [](const auto& path) {
    accept([&] {
      const Trajectory trajectory = read_tum_trajectory(path);
      for (const StampedPose& pose : trajectory)
        require(pose.T_world_camera.is_finite(), "a pose not finite");
      static_cast<void>(evaluate(trajectory, trajectory));
    });
  });
}

}  // namespace kinloop::fuzz
