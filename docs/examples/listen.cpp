// Listens to a run: prints keyframes, tracking losses and loop closures as they happen.
//
//   example_listen [SEED]      the simulated room with this seed

#include <cstdio>
#include <string>

#include "kinloop/slam/slam.hpp"
#include "simulator/simulated_source.hpp"

namespace {

class Printer : public kinloop::Listener {
 public:
  void on_frame(const kinloop::TrackedFrame& tracked) override {
    const bool lost = tracked.is_lost();
    if (lost != lost_) std::printf("frame %u: %s\n", tracked.id.value, lost ? "lost" : "tracking");
    lost_ = lost;
    if (tracked.keyframe.valid())
      std::printf("frame %u: keyframe %u\n", tracked.id.value, tracked.keyframe.value);
  }

  // The map is valid only during the call: copy what you need.
  void on_map(const kinloop::Map& map) override {
    for (; loops_ < map.loop_closures().size(); ++loops_) {
      const auto& loop = map.loop_closures()[loops_];
      std::printf("loop closed between keyframes %u and %u\n", loop.a.value, loop.b.value);
    }
  }

 private:
  bool lost_ = false;
  size_t loops_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  const std::string scene = argc > 1 ? std::string("sim:room:") + argv[1] : "sim:room";
  const auto source = kinloop::make_simulated_source(scene, {}, 0);
  Printer printer;
  kinloop::Slam slam(source->camera());
  slam.add_listener(printer);
  while (const auto frame = source->next()) slam.process(*frame);
  slam.finish();
}
