#pragma once
// Listens to a run and keeps the images of every keyframe together with surfels computed from them in the
// background. Surfels move with their keyframe. A short recording, or one with a static camera, has few
// keyframes, so frames between them are recorded too. Fuses the coloured cloud on request, at the current
// poses.

#include <memory>
#include <optional>

#include "dense/surfels/fuse_surfels.hpp"
#include "dense/up_direction.hpp"
#include "kinloop/back_end/executor.hpp"
#include "kinloop/core/timings.hpp"
#include "kinloop/io/map_file/map_file.hpp"
#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"
#include "kinloop/slam/listener.hpp"
#include "kinloop/slam/slam.hpp"

namespace kinloop {

/// Returns the camera with all estimated sensor corrections, for poses that were estimated along with them.
DenseCamera dense_camera(const RgbdCamera& camera, const SensorEstimate& estimate);

/// Returns the nominal camera with only the estimated times applied, for poses from another source.
DenseCamera time_calibrated_camera(const RgbdCamera& camera, const SensorEstimate& estimate);

class DenseRecorder : public Listener {
 public:
  DenseRecorder(const RgbdCamera& camera, const DenseOptions& options, const ExecutorOptions& executor = {});

  void on_frame(const TrackedFrame& result) override;
  void on_map(const Map&) override {}

  /// Restores the images of a map file. Their depth must be in the units of the camera.
  void restore(const SavedImages& saved);

  /// Waits for the jobs in flight. The functions below use what has been recorded so far.
  void wait_for_jobs();

  [[nodiscard]] size_t image_count() const { return recorded_.size(); }

  [[nodiscard]] FrameId frame_of_image(size_t index) const { return recorded_.at(index).frame; }

  /// Returns image `index` in the form stored in a map file.
  [[nodiscard]] SavedImages saved_images(size_t index) const {
    return {frame_of_image(index), images_.encoded(index)};
  }

  [[nodiscard]] const ImageStore& images() const { return images_; }

  /// Returns the images of one map component whose frames have a pose, at the poses of `log` and `map`.
  [[nodiscard]] std::vector<PosedImage> views(const FrameLog& log, const Map& map, uint32_t component) const;

  /// Returns the images of the component in which the run of `slam` was tracked. Waits for the jobs in
  /// flight.
  [[nodiscard]] std::vector<PosedImage> views(const Slam& slam) {
    wait_for_jobs();
    return views(slam.log(), slam.map(), slam.component());
  }
  /// Returns `views` with gains that equalise their colours, if enabled by the options. Waits for the jobs in
  /// flight.
  [[nodiscard]] std::vector<PosedImage> with_color_gains(std::span<const PosedImage> views,
                                                         const DenseCamera& camera, int threads);

  /// Fuses `views` into a coloured cloud. Waits for the jobs in flight.
  ColoredCloud fuse_views(std::span<const PosedImage> views, const DenseCamera& camera, int threads,
                          const Progress& progress);

  /// Fuses the component in which the run of `slam` was tracked.
  ColoredCloud fuse(const Slam& slam, int threads, const Progress& progress) {
    return fuse_views(views(slam), dense_camera(camera_, slam.sensor_estimate()), threads, progress);
  }

  /// Returns the up direction of the options; nullopt if it is to be estimated.
  [[nodiscard]] std::optional<UpEstimate> given_up() const;

  /// Returns the up direction of the options, else estimates it from the surfaces in `views`.
  UpEstimate up(std::span<const PosedImage> views, const DenseCamera& camera);

  /// Estimates the up direction of the component in which the run of `slam` was tracked.
  UpEstimate up(const Slam& slam) { return up(views(slam), dense_camera(camera_, slam.sensor_estimate())); }

  /// Returns the recorded images of a frame, if any. Every keyframe is recorded.
  [[nodiscard]] std::optional<RgbdImages> images_of(FrameId frame) const;

  /// Returns the time spent so far.
  [[nodiscard]] const Timings& timings() const { return timings_; }

 private:
  struct PendingFrame {
    FrameId frame;
    ColorImage color;
    cv::Mat depth_m;
  };
  /// Result of encoding a frame in the background.
  struct EncodedFrame {
    FrameId frame;
    EncodedImages images;
    std::optional<std::vector<uint8_t>> surfels = {};  // serialised with `to_bytes`
  };
  struct RecordedImage {
    FrameId frame;
    std::optional<size_t> surfels;  // index into surfel_store_; unset until computed
  };

  [[nodiscard]] bool should_record(const TrackedFrame& tracked) const;
  void submit(FrameId now);
  void add(std::vector<EncodedFrame> frames);
  void complete(const std::vector<FinishedJob>& jobs);
  void extract_missing_surfels(int threads);
  [[nodiscard]] ImageSurfels surfels(size_t image) const {
    return surfels_from_bytes(surfel_store_.load(*recorded_[image].surfels));
  }

  RgbdCamera camera_;
  DenseOptions options_;
  ImageStore images_;
  ByteStore surfel_store_;
  std::vector<RecordedImage> recorded_;  // per image
  std::vector<PendingFrame> pending_;
  uint32_t frames_ = 0;                 // located frames
  uint32_t frames_since_recorded_ = 0;  // located frames since the last recorded one
  Timings timings_;
  int lag_frames_;
  std::unique_ptr<Executor> executor_;  // last member: its jobs end before the rest is destroyed
};

}  // namespace kinloop
