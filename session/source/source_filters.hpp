#pragma once
// In: a source, and what is to be different about its frames. Out: a source with those frames.

#include <deque>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "drivers/live/frame_pairer.hpp"
#include "kinloop/sensor/source/forwarding_source.hpp"

namespace kinloop {

/// Adds `offset_s` to the stamps of depth and pairs each colour image with the depth image that is then
/// nearest. As many images as come in that time wait in memory; those without a partner are skipped and
/// counted.
class ShiftedDepthSource : public ForwardingSource {
 public:
  static constexpr double kMaxOffset_s = 5;  ///< of either sign

  /// Throws std::logic_error for an offset beyond the limit.
  ShiftedDepthSource(std::unique_ptr<FrameSource> source, double offset_s);

  std::optional<Frame> next() override;
  [[nodiscard]] SkippedFrames skipped() const override;

 private:
  void add(Frame frame);

  int64_t offset_ns_;
  FramePairer pairer_;
  bool finished_ = false;
};

/// Delivers the first frame of a source and each n-th after it, with consecutive ids and 1/n of the rate.
/// Frames between them are not read if the source is a PassableSource.
class ThinnedSource : public ForwardingSource {
 public:
  static constexpr int kMaxStep = 100'000;

  /// Throws std::logic_error for a null pointer, or a step below 1 or above the limit.
  ThinnedSource(std::unique_ptr<FrameSource> source, int step);

  std::optional<Frame> next() override;
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }

 private:
  /// Passes over one frame; false at the end.
  bool pass_over();

  int step_;
  RgbdCamera camera_;
  SourceInfo info_;
  uint32_t next_id_ = 0;
};

/// A source whose camera has the depth sensor that the user names, whatever the recording says.
class NamedSensorSource : public ForwardingSource {
 public:
  /// Throws std::logic_error for a null pointer.
  NamedSensorSource(std::unique_ptr<FrameSource> source, DepthSensorModel model)
      : ForwardingSource(std::move(source)), camera_(ForwardingSource::camera()) {
    camera_.sensor = depth_sensor(model, SensorOrigin::kCameraFile);
  }

  std::optional<Frame> next() override { return source().next(); }
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }

 private:
  RgbdCamera camera_;
};

/// Ignores the same pixels in each frame, such as those of the robot that carries the camera.
class MaskedSource : public ForwardingSource {
 public:
  /// The mask is an 8-bit PNG or JPEG of the size of the camera, black (0) where pixels are to be ignored.
  /// Throws InputError naming the file and the remedy.
  MaskedSource(std::unique_ptr<FrameSource> source, const std::filesystem::path& mask);

  std::optional<Frame> next() override;

 private:
  cv::Mat mask_;
};

/// Reads the first frames ahead, which stay the first ones of the source. An error is thrown in its turn.
class PeekedSource : public ForwardingSource {
 public:
  PeekedSource(std::unique_ptr<FrameSource> source, size_t frames);

  std::optional<Frame> next() override;

  [[nodiscard]] const std::deque<Frame>& first_frames() const { return frames_; }

 private:
  std::deque<Frame> frames_;
  std::exception_ptr error_;  ///< after `frames_`
};

}  // namespace kinloop
