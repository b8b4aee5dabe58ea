#include "drivers/openni2/oni_source.hpp"

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "drivers/images/encoded_image.hpp"
#include "drivers/images/first_reason.hpp"
#include "drivers/live/frame_pairer.hpp"
#include "drivers/openni2/oni_file.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/sensor/camera/possible_camera.hpp"
#include "kinloop/sensor/camera/registration.hpp"

namespace kinloop {
namespace {

class OniSource : public FrameSource {
 public:
  OniSource(const std::filesystem::path& path, const std::optional<RgbdCamera>& camera) : file_(path) {
    info_.name = path.string();
    color_ = node_of(OniStreamKind::kColor, "colour");
    depth_ = node_of(OniStreamKind::kDepth, "depth");
    const OniStream& color = stream(color_);
    info_.frames = color.images;
    info_.description =
        fmt::format("recording of OpenNI: {} frames, {} x {}", color.images, color.width, color.height);
    camera_ = camera ? *camera : recorded_camera();
    require_size(color_, "colour", camera_.color);
    require_size(depth_, "depth", camera_.depth.value_or(camera_.color));
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
      read_image();
    }
    if (given_ > 0) return std::nullopt;
    throw InputError(
        fmt::format("{}: no usable frame; record it again{}", info_.name, first_reason(skipped())));
  }

  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override {
    auto all = skipped_;
    all.add(file_.damage());
    all.add({"image", "no image of the other camera within 0.02 s"}, pairer_.unpaired());
    all.add({"image", "its timestamp does not increase"}, pairer_.out_of_order());
    return all;
  }

 private:
  [[nodiscard]] const OniStream& stream(uint32_t node) const { return file_.streams().at(node); }

  [[nodiscard]] uint32_t node_of(OniStreamKind kind, const char* name) const {
    for (const auto& [node, stream] : file_.streams()) {
      if (stream.kind == kind) return node;
    }
    throw InputError(fmt::format("{}: no stream of {}{}; record colour and depth", info_.name, name,
                                 file_.damage().empty() ? "" : " (" + file_.damage().front().reason + ")"));
  }

  [[nodiscard]] RgbdCamera recorded_camera() const {
    const OniStream& color = stream(color_);
    RgbdCamera camera;
    const cv::Size size(static_cast<int>(color.width), static_cast<int>(color.height));
    camera.color = camera_with_view(info_.name, size, color.horizontal_view_rad, color.vertical_view_rad);
    if (color.fps > 0) camera.fps = color.fps;
    return camera;
  }

  void require_size(uint32_t node, const char* name, const PinholeCamera& camera) const {
    const OniStream& images = stream(node);
    if (images.width == 0 || images.height == 0 || images.width > kMaxImagePixels / images.height) {
      throw InputError(fmt::format("{}: {} of {} x {} pixels is not possible; record it again", info_.name,
                                   name, images.width, images.height));
    }
    if (static_cast<int64_t>(images.width) == camera.width &&
        static_cast<int64_t>(images.height) == camera.height)
      return;
    throw InputError(
        fmt::format("{}: {} of {} x {} pixels where the camera has {} x {}; record both in the "
                    "same size, or use --camera FILE",
                    info_.name, name, images.width, images.height, camera.width, camera.height));
  }

  /// Passes the next image to the pairer, or detects the end.
  void read_image() {
    const auto image = file_.next();
    if (!image) {
      finished_ = true;
      return pairer_.finish();
    }
    try {
      const int64_t stamp_ns = checked_stamp_ns(image->stamp_ns);
      if (image->node == color_) pairer_.add_color(stamp_ns, decoded_color(image->data));
      if (image->node == depth_) pairer_.add_depth(stamp_ns, decoded_depth(image->data));
    } catch (const InputError& error) {
      skipped_.add({fmt::format("{} at {} ns", image->node == color_ ? "colour" : "depth", image->stamp_ns),
                    error.what()});
    }
  }

  [[nodiscard]] static OpenNiImage with_data(const OniStream& stream, size_t pixel_bytes, Bytes data) {
    return {static_cast<int>(stream.width),
            static_cast<int>(stream.height),
            pixel_bytes * stream.width,
            stream.pixels,
            stream.mirrored,
            data};
  }

  [[nodiscard]] ColorImage decoded_color(Bytes data) const {
    const OniStream& color = stream(color_);
    size_t pixel_bytes = 2;
    if (color.pixels == OpenNiPixels::kRgb) pixel_bytes = 3;
    if (color.pixels == OpenNiPixels::kGray) pixel_bytes = 1;
    OpenNiImage image = with_data(color, pixel_bytes, data);
    if (color.codec == "JPEG") {
      image.pixels = OpenNiPixels::kJpeg;
    } else if (color.codec != "NONE") {
      throw InputError(fmt::format("unknown codec '{}' of colour", color.codec));
    }
    return color_from(image);
  }

  [[nodiscard]] cv::Mat decoded_depth(Bytes data) const {
    const OniStream& depth = stream(depth_);
    if (depth.codec == "NONE") return depth_from(with_data(depth, sizeof(uint16_t), data));
    if (depth.codec != "16zT" && depth.codec != "16zP")
      throw InputError(fmt::format("unknown codec '{}' of depth", depth.codec));
    const cv::Size size(static_cast<int>(depth.width), static_cast<int>(depth.height));
    const cv::Mat values = decode_16z(data, size, depth.codec == "16zT");
    return depth_from(
        with_data(depth, sizeof(uint16_t), Bytes(values.data, sizeof(uint16_t) * values.total())));
  }

  SourceInfo info_;
  OniFile file_;
  uint32_t color_ = 0, depth_ = 0;
  RgbdCamera camera_;
  std::optional<DepthPreparation> preparation_;
  FramePairer pairer_;
  bool finished_ = false;
  size_t given_ = 0;
  SkippedFrames skipped_;
};

}  // namespace

std::unique_ptr<FrameSource> open_oni_recording(const std::filesystem::path& path,
                                                const std::optional<RgbdCamera>& camera) {
  return std::make_unique<OniSource>(path, camera);
}

}  // namespace kinloop
