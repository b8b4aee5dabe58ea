#pragma once
// Listens to a run and works out of every keyframe's images, in the background, the surfels of its surface,
// which move with the keyframe; keeps both. A short recording, or one of a camera that stands still, has few
// keyframes: frames between them are taken too. Out: the coloured cloud, whenever wanted, at the poses of
// that moment.

#include <memory>
#include <optional>

#include "kinloop/dense/cloud/fuse_surfels.hpp"
#include "kinloop/geometry/up_direction.hpp"
#include "kinloop/io/map_file/map_file.hpp"
#include "kinloop/slam/executor.hpp"
#include "kinloop/slam/frame_log.hpp"
#include "kinloop/slam/listener.hpp"
#include "kinloop/slam/slam.hpp"
#include "kinloop/slam/timings.hpp"

namespace kinloop {

/// The camera with all that was found of it: as it goes with poses that were found along with it.
DenseCamera dense_camera(const RgbdCamera& camera, const SensorEstimate& sensor);

/// The camera as it is known, but for the times that were found: as it goes with poses from elsewhere.
DenseCamera time_calibrated_camera(const RgbdCamera& camera, const SensorEstimate& sensor);

class DenseRecorder : public Listener {
 public:
  DenseRecorder(const RgbdCamera& camera, const DenseOptions& options, const ExecutorOptions& executor = {});

  void on_frame(const FrameResult& result, const PreparedFrame& frame) override;
  void on_map(const Map&) override {}

  /// Keeps images of a map file. Their depth must be in the units of the camera.
  void restore(const SavedImages& saved);

  /// Waits for the work in flight; below is what was taken in so far.
  void wait_for_jobs();

  [[nodiscard]] size_t image_count() const { return recorded_.size(); }

  [[nodiscard]] FrameId frame_of_image(size_t index) const { return recorded_.at(index).frame; }

  /// What a map file keeps of image `index`.
  [[nodiscard]] SavedImages saved_images(size_t index) const {
    return {frame_of_image(index), images_.encoded(index)};
  }

  [[nodiscard]] const ImageStore& images() const { return images_; }

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
  [[nodiscard]] const Timings& timings() const { return timings_; }

 private:
  struct PendingFrame {
    FrameId frame;
    RgbdImages images;
  };
  /// What is worked out of a frame's images in the background.
  struct EncodedFrame {
    FrameId frame;
    EncodedImages images;
    std::vector<uint8_t> surfels;  // as `to_bytes` gives it
  };
  struct RecordedImage {
    FrameId frame;
    std::optional<size_t> surfels;  // index into surfel_store_; not yet made of images that were restored
  };

  [[nodiscard]] bool should_record(const FrameResult& result) const;
  void submit(FrameId now);
  void add(std::vector<EncodedFrame> frames);
  void complete(const std::vector<FinishedJob>& jobs);
  void make_missing_patches(int threads);
  [[nodiscard]] ImageSurfels surfels(size_t image) const {
    return surfels_from_bytes(surfel_store_.load(*recorded_[image].surfels));
  }

  RgbdCamera camera_;
  DenseOptions options_;
  ImageStore images_;
  ByteStore surfel_store_;
  std::vector<RecordedImage> recorded_;  // per image
  std::vector<PendingFrame> pending_;
  uint32_t frames_ = 0;                 // that were located
  uint32_t frames_since_recorded_ = 0;  // of these
  Timings timings_;
  int lag_frames_;
  std::unique_ptr<Executor> executor_;  // last: its jobs end first
};

}  // namespace kinloop
