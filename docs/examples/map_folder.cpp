// Maps a recorded sequence in TUM layout. Writes trajectory.txt, map.ply (a coloured cloud) and map.kinmap.
//
//   example_map_folder SEQUENCE

#include <cstdio>

#include "drivers/datasets/tum_source.hpp"
#include "session/session.hpp"

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: example_map_folder SEQUENCE\n");
    return 2;
  }
  kinloop::TumSource source(argv[1]);
  kinloop::Session session(source);
  session.run();
  session.write_trajectory("trajectory.txt");
  session.write_cloud("map.ply");
  session.write_map("map.kinmap");  // for localization or further mapping
  std::printf("%zu keyframes\n", session.slam().map().keyframes().size());
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 3;
}
