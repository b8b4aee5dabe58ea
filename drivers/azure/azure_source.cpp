#include "drivers/azure/azure_source.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/azure/azure_recording.hpp"
#include "drivers/image_files/image_file.hpp"
#include "drivers/images/encoded_image.hpp"
#include "drivers/images/first_reason.hpp"
#include "drivers/live/frame_pairer.hpp"
#include "drivers/ros/messages/ros_image.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/sensor/camera/possible_camera.hpp"
#include "kinloop/sensor/camera/registration.hpp"

namespace kinloop {
namespace {

constexpr const char* kCalibrationFile = "calibration.json";

class AzureSource : public FrameSource {
 public:
  AzureSource(const std::filesystem::path& path, const std::optional<RgbdCamera>& camera)
      : file_(open(path)) {
    info_.name = path.string();
    color_track_ = track_named("COLOR");
    depth_track_ = track_named("DEPTH");
    info_.frames = file_.tracks()[color_track_].frames;
    if (camera) {
      camera_ = *camera;
    } else {
      use_factory_calibration();
    }
    camera_.sensor.set_by_source(DepthSensorModel::kAzureKinect);
    require_possible(camera_, info_.name);
    preparation_.emplace(camera_);
  }

  std::optional<Frame> next() override {
    while (true) {
      if (auto frame = pairer_.next()) {
        ++given_;
        frame->depth_m = (*preparation_)(frame->depth_m);
        return frame;
      }
      if (finished_) break;
      read_block();
    }
    if (given_ == 0)
      throw InputError(fmt::format("{}: no usable frame{}", info_.name, first_reason(skipped())));
    return std::nullopt;
  }

  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override {
    auto all = skipped_;
    all.add({"image", "no image of the other camera within 0.02 s"}, pairer_.unpaired());
    all.add({"image", "its timestamp does not increase"}, pairer_.out_of_order());
    return all;
  }

 private:
  static MatroskaFile open(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
      throw InputError(fmt::format("{}: no such file; check the path", path.string()));
    return MatroskaFile(path);
  }

  [[nodiscard]] size_t track_named(const std::string& name) const {
    const auto& tracks = file_.tracks();
    const auto found =
        std::find_if(tracks.begin(), tracks.end(), [&](const auto& t) { return t.name == name; });
    if (found == tracks.end())
      throw InputError(fmt::format(
          "{}: no track {}: not a recording of an Azure Kinect with colour and depth", info_.name, name));
    return static_cast<size_t>(found - tracks.begin());
  }

  void use_factory_calibration() {
    const auto text = file_.attachment(kCalibrationFile);
    if (!text)
      throw InputError(
          fmt::format("{}: {} is not attached; use --camera FILE", info_.name, kCalibrationFile));
    const MatroskaTrack &color = file_.tracks()[color_track_], &depth = file_.tracks()[depth_track_];
    try {
      const auto calibration =
          read_azure_calibration(*text, {color.width, color.height}, {depth.width, depth.height});
      camera_.color = calibration.color;
      camera_.depth = calibration.depth;
      camera_.T_color_depth = calibration.T_color_depth;
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}; use --camera FILE", info_.name, error.what()));
    }
  }

  /// Passes the next image to the pairer, or detects the end.
  void read_block() {
    const auto block = file_.next();
    if (!block) {
      finished_ = true;
      return pairer_.finish();
    }
    try {
      if (block->track == color_track_) add_color(*block);
      if (block->track == depth_track_) add_depth(*block);
    } catch (const InputError& error) {
      skipped_.add(
          {fmt::format("{} at {} ns", file_.tracks()[block->track].name, block->stamp_ns), error.what()});
    }
  }

  void add_color(const MatroskaBlock& block) {
    const MatroskaTrack& track = file_.tracks()[color_track_];
    require_encoded_size(block.data, camera_.color);
    ColorImage color = decoded_color(track, block.data);
    require_size(color.size(), camera_.color);
    pairer_.add_color(checked_stamp_ns(block.stamp_ns), std::move(color));
  }

  void add_depth(const MatroskaBlock& block) {
    const MatroskaTrack& track = file_.tracks()[depth_track_];
    require_encoded_size(block.data, camera_.depth.value_or(camera_.color));
    cv::Mat depth_m = decoded_depth(track, block.data);
    require_size(depth_m.size(), camera_.depth ? *camera_.depth : camera_.color);
    pairer_.add_depth(checked_stamp_ns(block.stamp_ns), depth_m);
  }

  static ColorImage decoded_color(const MatroskaTrack& track, Bytes data) {
    if (track.fourcc == "MJPG" || track.fourcc == "png") return decode_embedded_color(data);
    if (track.fourcc == "YUY2")
      return color_from(
          {track.width, track.height, 2 * static_cast<size_t>(track.width), "yuyv", false, data});
    if (track.fourcc != "NV12")
      throw InputError(fmt::format("unknown encoding '{}'; expected MJPG, YUY2, NV12", track.fourcc));
    const int rows = track.height * 3 / 2;
    const cv::Mat pixels = gray_pixels(data, {track.width, rows});
    cv::Mat color;
    cv::cvtColor(pixels, color, cv::COLOR_YUV2BGR_NV12);
    return color;
  }

  static cv::Mat gray_pixels(Bytes data, cv::Size size) {
    const bool even = size.width > 0 && size.width % 2 == 0 && size.height > 0 && size.height % 3 == 0;
    if (!even || data.size() < static_cast<size_t>(size.width) * static_cast<size_t>(size.height))
      throw InputError("an NV12 image is truncated");
    return {size, CV_8UC1, const_cast<uint8_t*>(data.data())};
  }

  static cv::Mat decoded_depth(const MatroskaTrack& track, Bytes data) {
    if (track.fourcc == "png") return depth_from_compressed("16UC1", data);
    if (track.fourcc != "b16g")
      throw InputError(fmt::format("unknown depth encoding '{}'; expected b16g", track.fourcc));
    constexpr bool kBigEndian = true;
    return depth_from(
        {track.width, track.height, 2 * static_cast<size_t>(track.width), "16UC1", kBigEndian, data});
  }

  /// Before decoding: a small block may hold a huge image.
  static void require_encoded_size(Bytes data, const PinholeCamera& camera) {
    if (const auto size = encoded_size(as_text(data))) require_size(*size, camera);
  }

  static void require_size(const cv::Size& size, const PinholeCamera& camera) {
    if (size.width == camera.width && size.height == camera.height) return;
    throw InputError(fmt::format("{} x {} pixels where the camera has {} x {}", size.width, size.height,
                                 camera.width, camera.height));
  }

  SourceInfo info_;
  MatroskaFile file_;
  size_t color_track_ = 0, depth_track_ = 0;
  RgbdCamera camera_;
  std::optional<DepthPreparation> preparation_;
  FramePairer pairer_;
  bool finished_ = false;
  size_t given_ = 0;
  SkippedFrames skipped_;
};

}  // namespace

std::unique_ptr<FrameSource> open_azure_recording(const std::filesystem::path& path,
                                                  const std::optional<RgbdCamera>& camera) {
  return std::make_unique<AzureSource>(path, camera);
}

}  // namespace kinloop
