#pragma once
// Listens to a run and works out of every keyframe's images, in the background, a patch of surface that moves
// with the keyframe; keeps both. A short recording, or one of a camera that stands still, has few keyframes:
// frames between them are taken too. Out: the coloured cloud, whenever wanted, at the poses of that moment.

#include <memory>
#include <optional>

#include "kinloop/dense/fuse_patches.hpp"
#include "kinloop/geometry/up_direction.hpp"
#include "kinloop/output/map_file.hpp"
#include "kinloop/slam/executor.hpp"
#include "kinloop/slam/frame_log.hpp"
#include "kinloop/slam/listener.hpp"
#include "kinloop/slam/room_times.hpp"
#include "kinloop/slam/slam.hpp"

namespace kinloop {

/// The camera with all that was found of it: as it goes with poses that were found along with it.
DenseCamera dense_camera(const RgbdCamera& camera, const SensorEstimate& sensor);

/// The camera as it is known, but for the times that were found: as it goes with poses from elsewhere.
DenseCamera timed_camera(const RgbdCamera& camera, const SensorEstimate& sensor);

class DenseRecorder : public Listener {
 public:
  DenseRecorder(const RgbdCamera& camera, const DenseOptions& options, const ExecutorOptions& executor = {});

  void on_frame(const FrameResult& result, const PreparedFrame& frame) override;
  void on_map(const Map&) override {}

  /// Keeps images of a map file. Their depth must be in the units of the camera.
  void restore(const SavedImages& saved);

  /// Waits for the work in flight; below is what was taken in so far.
  void finish_work();

  [[nodiscard]] size_t image_count() const { return kept_.size(); }

  [[nodiscard]] FrameId frame_of_image(size_t index) const { return kept_.at(index).frame; }

  /// What a map file keeps of image `index`.
  [[nodiscard]] SavedImages saved_images(size_t index) const {
    return {frame_of_image(index), images_.encoded(index)};
  }

  [[nodiscard]] const KeyframeImages& images() const { return images_; }

  /// The images of one component of the map whose place is known, at the poses of `log` and `map`.
  [[nodiscard]] std::vector<PosedImage> views(const FrameLog& log, const Map& map, uint32_t component) const;

  /// Those of the component in which the run of `slam` was tracked.
  [[nodiscard]] std::vector<PosedImage> views(const Slam& slam) const {
    return views(slam.log(), slam.map(), slam.component());
  }
  /// `views` with the factors that even out their colours, where the options say so; waits for the work in
  /// flight.
  [[nodiscard]] std::vector<PosedImage> with_color_gains(std::span<const PosedImage> views,
                                                         const DenseCamera& camera, int threads);

  /// The coloured cloud of `views`, waiting for the work in flight.
  ColoredCloud fuse_views(std::span<const PosedImage> views, const DenseCamera& camera, int threads,
                          const Progress& progress);

  /// The same of the component in which the run of `slam` was tracked.
  ColoredCloud fuse(const Slam& slam, int threads, const Progress& progress) {
    return fuse_views(views(slam), dense_camera(camera_, slam.sensor()), threads, progress);
  }

  /// Which way is up, by what `views` saw of surfaces.
  UpEstimate up(std::span<const PosedImage> views, const DenseCamera& camera);

  /// The same for the component in which the run of `slam` was tracked.
  UpEstimate up(const Slam& slam) { return up(views(slam), dense_camera(camera_, slam.sensor())); }

  /// The images of a frame, where they were kept: those of every keyframe are.
  [[nodiscard]] std::optional<RgbdImages> images_of(FrameId frame) const;

  /// What the work cost.
  [[nodiscard]] const RoomTimes& times() const { return times_; }

 private:
  struct Waiting {
    FrameId frame;
    RgbdImages images;
  };
  struct Kept {
    FrameId frame;
    std::optional<size_t> patch;  // index into patches_; not yet made of images that were restored
  };

  [[nodiscard]] bool wants(const FrameResult& result) const;
  void submit(FrameId now);
  void take_in(std::vector<FinishedJob> jobs);
  void make_missing_patches(int threads);
  [[nodiscard]] DepthPatch patch(size_t image) const {
    return patch_of_bytes(patches_.load(*kept_[image].patch));
  }

  RgbdCamera camera_;
  DenseOptions options_;
  KeyframeImages images_;
  ByteStore patches_;
  std::vector<Kept> kept_;  // per image
  std::vector<Waiting> waiting_;
  uint32_t frames_ = 0;             // that were located
  uint32_t frames_since_kept_ = 0;  // of these
  RoomTimes times_;
  std::unique_ptr<Executor> executor_;  // last: its jobs end first
};

}  // namespace kinloop
