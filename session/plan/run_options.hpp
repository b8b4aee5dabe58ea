#pragma once
// Everything that `kinloop run --set key=value` can change.

#include "dense/options.hpp"
#include "drivers/live/kinect_options.hpp"
#include "kinloop/slam/options.hpp"
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

/// Returns whether an assignment "key=value" sets this option.
bool assigns(std::span<const std::string> assignments, std::string_view key);

/// Returns options whose limits of depth are without what is beyond the range of the sensor, see
/// within_range.
RunOptions within_range(RunOptions options, const DepthSensor& sensor);

/// Same, with the minimum of the sensor if it is known and the user did not assign one.
RunOptions with_sensor_range(RunOptions options, const DepthSensor& sensor,
                             std::span<const std::string> assignments);

/// Returns options with this minimum of depth, of all dense results.
RunOptions with_minimum_depth(RunOptions options, double min_depth_m);

/// Divides this memory among images, descriptors and patches of keyframes; the fusion of the dense map, which
/// comes after them, gets no more than it.
RunOptions with_memory_limit(RunOptions options, int memory_mib);

/// `options` with the assignments ("key=value") applied in order. The limits of depth are those of the dense
/// map for everything made of depth: mesh, occupancy map, viewer.
RunOptions run_options_with(RunOptions options, std::span<const std::string> assignments);

}  // namespace kinloop
