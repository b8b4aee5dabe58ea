#pragma once
// A map of two visits that a loop closure joins.

#include <memory>
#include <utility>

#include "kinloop/map/map.hpp"
#include "kinloop/sensor/sensor.hpp"
#include "tests/loop/wall_view.hpp"
#include "tests/sensor/vga_surfaces.hpp"
#include "tests/support/synthetic_world.hpp"

namespace kinloop::test {

/// Two visits along a wall that faces the camera, 2 m away, from places 0.5 m apart, joined at the first
/// keyframes of both.
class JoinedVisits {
 public:
  static constexpr int kPerVisit = 12;

  JoinedVisits() {
    for (int i = 0; i < kPerVisit; ++i) add(i, 0, false);
  }

  /// Adds the keyframe of the second visit at place `index`; the pictures on its wall may be others.
  void revisit(int index, bool different) {
    if (map.keyframes().size() > kPerVisit) {
      add(index, 0, different);
      map.set_visit(map.keyframes().back().id, 1);
      return;
    }
    add(index, 1, different);
    LoopClosure closure{loop.a, loop.b, SE3{}};
    closure.stage = LoopStage::kVerified;
    map.add_loop_closure(closure);
  }

  /// Adds those of all places from `first` to before `end`.
  void revisit(int first, int end, bool different) {
    for (int i = first; i < end; ++i) revisit(i, different);
  }

  const LoopEnds loop{KeyframeId{0}, KeyframeId{kPerVisit}};
  const std::shared_ptr<const SurfaceGrid> wall = std::make_shared<const SurfaceGrid>(
      make_surface_grid(vga_surface_camera(), cv::Mat(480, 640, CV_32FC1, cv::Scalar(2))));
  const Sensor sensor{vga_camera()};
  Map map;

 private:
  void add(int index, uint32_t component, bool different) {
    Features features = *painted_wall_view(2);
    if (different) repaint(features);
    const auto number = static_cast<uint32_t>(map.keyframes().size());
    map.add_keyframe(FrameId{number}, number, camera_at(0, {0.5 * index, 0, 0}),
                     std::make_shared<const Features>(std::move(features)), component);
    map.set_surfaces(KeyframeId{number}, wall);
  }
};

}  // namespace kinloop::test
