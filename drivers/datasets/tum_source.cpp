#include "drivers/datasets/tum_source.hpp"

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "drivers/datasets/camera_selection.hpp"
#include "kinloop/base/errors.hpp"
#include "kinloop/base/log.hpp"
#include "kinloop/sensor/image_file.hpp"

namespace kinloop {
namespace {

constexpr const char* kColorRemedy = "specify the camera of these images with --camera";
constexpr const char* kDepthRemedy =
    "depth must have the size of colour, or its own camera ('depth' and 'T_color_depth' in camera.yaml)";

void require_size(const cv::Size& size, const std::filesystem::path& path, const PinholeCamera& camera,
                  const char* remedy) {
  if (size.width == camera.width && size.height == camera.height) return;
  throw ImageFormatError(fmt::format("{}: {} x {} pixels where the camera has {} x {}; {}", path.string(),
                                     size.width, size.height, camera.width, camera.height, remedy));
}

/// Throws InputError if all files named in a list are missing.
void require_some_there(const std::vector<FrameFiles>& frames, std::filesystem::path FrameFiles::*file,
                        const std::filesystem::path& folder) {
  for (const FrameFiles& files : frames) {
    std::error_code absent;
    if (std::filesystem::exists(files.*file, absent)) return;
  }
  if (frames.empty()) return;
  throw InputError(fmt::format("{}: no such file, nor any of the {} listed files; names are relative to {}",
                               (frames.front().*file).string(), frames.size(), folder.string()));
}

}  // namespace

TumSource::TumSource(const std::filesystem::path& folder) : TumSource(folder, choose_camera(folder)) {}

TumSource::TumSource(const std::filesystem::path& folder, const RgbdCamera& camera) : camera_(camera) {
  TumListing listing = read_tum_listing(folder);
  frames_ = std::move(listing.frames);
  skipped_ = std::move(listing.skipped);
  info_.name = folder.string();
  info_.frames = frames_.size() + skipped_.size();
  const auto ground_truth = folder / "groundtruth.txt";
  if (std::filesystem::exists(ground_truth)) {
    info_.ground_truth = read_tum_trajectory(ground_truth);
    if (info_.ground_truth.empty())
      log::warn("{}: contains no pose: the trajectory error will not be computed", ground_truth.string());
  }
  if (camera_.depth) registration_.emplace(camera_);
  require_some_there(frames_, &FrameFiles::color, folder);
  require_some_there(frames_, &FrameFiles::depth, folder);
  require_expected_format();
}

void TumSource::require_expected_format() const {
  constexpr int kFormatCheckFrames =
      3;  // a wrong camera or image format affects every frame, damage only its own
  int wrong = 0;
  std::string first;
  for (const FrameFiles& files : frames_) {
    try {
      static_cast<void>(read_images(files));
      return;
    } catch (const ImageFormatError& error) {
      if (wrong == 0) first = error.what();
      if (++wrong == kFormatCheckFrames) throw InputError(first);
    } catch (const InputError&) {
      continue;  // next() counts it
    }
  }
}

std::optional<RgbdFrame> TumSource::next() {
  while (next_file_ < frames_.size()) {
    const FrameFiles& files = frames_[next_file_++];
    try {
      RgbdFrame frame = read_frame(files);
      frame.id = FrameId{next_id_++};
      return frame;
    } catch (const InputError& error) {
      skipped_.push_back({files.color.filename().string(), error.what()});
    }
  }
  if (next_id_ == 0) {
    const SkippedFrame& first = skipped_[skipped_.size() - frames_.size()];  // after those of the lists
    throw InputError(fmt::format("{}: none of the {} frames is usable; the first: {}", info_.name,
                                 info_.frames, first.reason));
  }
  return std::nullopt;
}

RgbdFrame TumSource::read_images(const FrameFiles& files) const {
  RgbdFrame frame;
  frame.stamp_ns = files.stamp_ns;
  frame.color = read_color_image(files.color);
  require_size(frame.color.size(), files.color, camera_.color, kColorRemedy);
  frame.depth_m = read_depth_image(files.depth, camera_.depth_scale);
  require_size(frame.depth_m.size(), files.depth, camera_.depth ? *camera_.depth : camera_.color,
               kDepthRemedy);
  return frame;
}

RgbdFrame TumSource::read_frame(const FrameFiles& files) const {
  RgbdFrame frame = read_images(files);
  if (camera_.depth_shift_m != 0)
    cv::add(frame.depth_m, camera_.depth_shift_m, frame.depth_m, frame.depth_m > 0);
  if (registration_) frame.depth_m = (*registration_)(frame.depth_m);
  return frame;
}

}  // namespace kinloop
