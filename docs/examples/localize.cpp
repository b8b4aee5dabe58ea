// Localizes a sequence in a saved map, without changing the map.
//
//   example_localize MAP.kinmap SEQUENCE

#include <cstdio>

#include "drivers/datasets/tum_source.hpp"
#include "kinloop/io/map_file/map_file.hpp"
#include "kinloop/slam/slam.hpp"

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: example_localize MAP.kinmap SEQUENCE\n");
    return 2;
  }
  auto [map, damage] = kinloop::MapReader(argv[1]).read();
  if (damage.any()) std::fprintf(stderr, "warning: %s\n", kinloop::describe(damage).c_str());

  kinloop::TumSource source(argv[2]);
  kinloop::SlamOptions options;
  options.localize_only = true;
  kinloop::Slam slam(source.camera(), options);
  slam.add_map(std::move(map));

  int located = 0, frames = 0;
  while (const auto frame = source.next()) {
    located += slam.process(*frame).is_lost() ? 0 : 1;
    ++frames;
  }
  kinloop::write_tum_trajectory("trajectory.txt", slam.finish());
  std::printf("%d of %d frames located\n", located, frames);
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 3;
}
