// The live mesh of a run: its cost on the viewer's thread, what it sends, and its vertices at the end.
//
//   bench_live_mesh SEQUENCE OUT_FOLDER [VOXEL_M]
//
// Writes trajectory.txt and live_mesh.ply, the vertices in the frame of the trajectory, for `kinloop bench
// cloud` (simulated rooms). The viewer's thread always keeps up here: it has no other load to wait for.

#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "dense/files/ply.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "session/session.hpp"
#include "session/source/open_frame_source.hpp"
#include "viewer/live/incremental_mesh.hpp"
#include "viewer/live/run_scene.hpp"
#include "viewer/scene/wire_format.hpp"

namespace kinloop {
namespace {

/// What browsers would have of the mesh, and what it took.
class Watcher {
 public:
  Watcher(const RgbdCamera& camera, const ViewerOptions& options)
      : camera_(camera), mesh_(camera.color, options) {}

  RunFeed& feed() { return feed_; }

  /// Does what the viewer's thread does until nothing is left to do.
  void update(const SensorEstimate& sensor, bool finished) {
    const RunEvents events = feed_.take();
    if (events.map) T_world_keyframe_ = events.map->T_world_keyframe;
    const Stopwatch watch;
    mesh_.add(events.mesh_frames);
    const DenseCamera dense = time_calibrated_camera(camera_, sensor);
    for (bool busy = true; busy;) {
      const size_t fused_before = mesh_.fused_frames();
      const auto changed = mesh_.update(T_world_keyframe_, dense, finished);
      for (const MeshPiece& piece : changed) {
        sent_bytes_ += encode_mesh_piece(piece).size();
        pieces_.insert_or_assign(piece.index, piece);
      }
      sent_pieces_ += changed.size();
      busy = !changed.empty() || mesh_.fused_frames() > fused_before;
    }
    cpu_s_ += watch.cpu_s();
    blocks_ = std::max(blocks_, mesh_.mesh().blocks_in_memory());
  }

  void report(size_t frames) const {
    size_t vertices = 0, triangles = 0, bytes = 0;
    for (const auto& [index, piece] : pieces_) {
      vertices += piece.surface.mesh.points.size();
      triangles += piece.surface.mesh.triangles.size();
      bytes += encode_mesh_piece(piece).size();
    }
    fmt::print(
        "{:.2f} CPU ms a frame, {} frames fused, {} pieces of {} submaps, {} sent, {} vertices, {} "
        "triangles\n",
        1e3 * cpu_s_ / static_cast<double>(frames), mesh_.fused_frames(), pieces_.size(),
        mesh_.mesh().submaps(), sent_pieces_, vertices, triangles);
    fmt::print("{:.1f} MB at the end, {:.1f} MB sent, {} MiB of voxels at most\n",
               static_cast<double>(bytes) / 1e6, static_cast<double>(sent_bytes_) / 1e6, blocks_ / 256);
  }

  [[nodiscard]] ColoredCloud vertices() const {
    ColoredCloud cloud;
    for (const auto& [index, piece] : pieces_) {
      const SE3& T_world_anchor = T_world_keyframe_[piece.anchor.value];
      for (const auto& p : piece.surface.mesh.points)
        cloud.points.emplace_back((T_world_anchor * p.cast<double>()).cast<float>());
      cloud.colors.insert(cloud.colors.end(), piece.surface.mesh.colors.begin(),
                          piece.surface.mesh.colors.end());
    }
    return cloud;
  }

 private:
  RgbdCamera camera_;
  RunFeed feed_;
  IncrementalMesh mesh_;
  std::vector<SE3> T_world_keyframe_;
  std::map<uint32_t, MeshPiece> pieces_;
  size_t sent_pieces_ = 0, sent_bytes_ = 0, blocks_ = 0;
  double cpu_s_ = 0;
};

void run(const std::string& sequence, const std::filesystem::path& out, double voxel_m) {
  SourceRequest request;
  request.sequence = sequence;
  const auto source = open_frame_source(request);
  Session session(*source);
  Watcher watcher(source->camera(), {.voxel_m = voxel_m});
  session.add_listener(watcher.feed());
  size_t frames = 0;
  for (auto frame = session.next(); frame; frame = session.next(), ++frames) {
    session.process(*frame);
    watcher.update(session.slam().sensor_estimate(), false);
  }
  session.finish();
  watcher.feed().on_finish(session.slam().log(), session.slam().map());
  watcher.update(session.slam().sensor_estimate(), true);
  watcher.report(frames);
  std::filesystem::create_directories(out);
  session.write_trajectory(out / "trajectory.txt");
  write_ply(out / "live_mesh.ply", watcher.vertices());
}

}  // namespace
}  // namespace kinloop

int main(int argc, char** argv) {
  if (argc < 3) return fmt::print(stderr, "usage: bench_live_mesh SEQUENCE OUT_FOLDER [VOXEL_M]\n"), 2;
  kinloop::run(argv[1], argv[2], argc > 3 ? std::stod(argv[3]) : 0.01);
}
