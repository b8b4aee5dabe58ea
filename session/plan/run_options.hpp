#pragma once
// Everything that `kinloop run --set key=value` can change.

#include <span>
#include <string>
#include <vector>

#include "dense/options.hpp"
#include "drivers/live/kinect_options.hpp"
#include "kinloop/slam/options.hpp"
#include "session/input/input_traits.hpp"
#include "session/plan/viewer_options.hpp"
#include "simulator/simulated_source.hpp"

namespace kinloop {

/// The options of the system stand at the top ("features.count"), those of the dense map, the mesh, the
/// occupancy map, the simulation, live cameras and the viewer under names of their own ("dense.voxel_m",
/// "sim.frames").
struct RunOptions {
  SlamOptions slam;
  DenseOptions dense;
  MeshOptions mesh;
  OccupancyOptions occupancy;
  SimulationOptions sim;
  KinectOptions kinect;
  ViewerOptions viewer;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    SlamOptions::fields(self.slam, visit);
    visit("dense", self.dense);
    visit("mesh", self.mesh);
    visit("occupancy", self.occupancy);
    visit("sim", self.sim, Expert{});  // kinloop simulate --help lists them
    visit("kinect", self.kinect);
    visit("viewer", self.viewer);
  }

  static OptionHistory history() { return SlamOptions::history(); }
};

/// `options` with the assignments ("key=value") applied in order. The limits of depth are those of the dense
/// map for everything made of depth: mesh, occupancy map, viewer.
RunOptions run_options_with(RunOptions options, std::span<const std::string> assignments);

/// Divides this memory among images, descriptors and patches of keyframes; the fusion of the dense map, which
/// comes after them, gets no more than it.
RunOptions with_memory_limit(RunOptions options, int memory_mib);

/// A way to do less for each frame.
struct WorkLevel {
  double percent;                        ///< of one core at 30 Hz, see docs/tune.md
  std::vector<std::string> assignments;  ///< key=value
};

/// Returns the levels, from that of the defaults to that of the least work. Each one takes less than the one
/// before, and costs accuracy.
const std::vector<WorkLevel>& work_levels();

/// Returns the most accurate level that takes at most `percent` of a core; the last one if none does.
const WorkLevel& work_level(double percent);

/// Returns options with that level; warns if it takes more.
RunOptions within_budget(const RunOptions& options, double percent);

/// Returns options whose limits of depth are without what is beyond the range of the sensor, see
/// within_range.
RunOptions within_range(RunOptions options, const DepthSensor& sensor);

/// Returns options that suit the input: results of live frames are applied when ready, and depth is limited
/// to where the sensor measures and the scene is. What the user assigned stays, but for what is beyond the
/// range of the sensor.
RunOptions suited_to(const InputTraits& input, RunOptions options, std::span<const std::string> assignments);

}  // namespace kinloop
