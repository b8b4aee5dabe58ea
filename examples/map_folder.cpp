// Maps a recorded sequence: trajectory.txt, map.ply (a coloured cloud) from a folder in TUM layout.
//
//   example_map_folder SEQUENCE

#include <cstdio>

#include "drivers/datasets/tum_source.hpp"
#include "kinloop/io/point_cloud/ply.hpp"
#include "kinloop/slam/dense_recorder.hpp"
#include "kinloop/slam/slam.hpp"

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: example_map_folder SEQUENCE\n");
    return 2;
  }
  kinloop::TumSource source(argv[1]);
  kinloop::Slam slam(source.camera());
  kinloop::DenseRecorder dense(source.camera(), {});
  slam.add_listener(dense);
  while (const auto frame = source.next()) slam.process(*frame);

  kinloop::write_tum_trajectory("trajectory.txt", slam.finish());
  const kinloop::ColoredCloud cloud = dense.fuse(slam, 0, {});
  kinloop::write_ply("map.ply", cloud);
  std::printf("%zu keyframes, %zu points\n", slam.map().keyframes().size(), cloud.size());
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 3;
}
