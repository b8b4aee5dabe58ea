#include "kinloop/sensor/tum_source.hpp"

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/log.hpp"
#include "kinloop/sensor/camera_choice.hpp"
#include "kinloop/sensor/image_file.hpp"

namespace kinloop {
namespace {

/// What is wrong with the size of the image; empty where it has the size of the camera.
std::string misfit_of(const cv::Mat& image, const std::filesystem::path& path, const PinholeCamera& camera) {
  if (image.cols == camera.width && image.rows == camera.height) return {};
  return fmt::format(
      "{}: {} x {} pixels where the camera has {} x {}; give the camera of these images with --camera",
      path.string(), image.cols, image.rows, camera.width, camera.height);
}

/// Throws InputError unless the image has the size of the camera.
void require_size(const cv::Mat& image, const std::filesystem::path& path, const PinholeCamera& camera) {
  if (const std::string misfit = misfit_of(image, path, camera); !misfit.empty()) throw InputError(misfit);
}

/// A wrong camera spoils every frame, a damaged file only its own: the first few images that can be read at
/// all tell which it is, without decoding the whole sequence.
void require_camera_fits(const std::vector<FrameFiles>& frames, const PinholeCamera& camera) {
  constexpr int kMisfitsToBelieve = 3;
  int misfits = 0;
  std::string first_misfit;
  for (const FrameFiles& files : frames) {
    cv::Mat image;
    try {
      image = read_color_image(files.color);
    } catch (const InputError&) {
      continue;  // next() will count it
    }
    const std::string misfit = misfit_of(image, files.color, camera);
    if (misfit.empty()) return;
    if (misfits == 0) first_misfit = misfit;
    if (++misfits == kMisfitsToBelieve) throw InputError(first_misfit);
  }
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
    if (info_.ground_truth.empty()) log::warn("{}: holds no pose: no error is told", ground_truth.string());
  }
  if (camera_.depth) registration_.emplace(camera_);
  require_camera_fits(frames_, camera_.color);
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
    const SkippedFrame& first = skipped_[skipped_.size() - frames_.size()];  // after the rows of the lists
    throw InputError(fmt::format("{}: none of its {} frames can be used; the first one: {}", info_.name,
                                 info_.frames, first.reason));
  }
  return std::nullopt;
}

RgbdFrame TumSource::read_frame(const FrameFiles& files) const {
  RgbdFrame frame;
  frame.stamp_ns = files.stamp_ns;
  frame.color = read_color_image(files.color);
  require_size(frame.color, files.color, camera_.color);
  frame.depth_m = read_depth_image(files.depth, camera_.depth_scale);
  require_size(frame.depth_m, files.depth, camera_.depth ? *camera_.depth : camera_.color);
  if (camera_.depth_shift_m != 0)
    cv::add(frame.depth_m, camera_.depth_shift_m, frame.depth_m, frame.depth_m > 0);
  if (registration_) frame.depth_m = (*registration_)(frame.depth_m);
  return frame;
}

}  // namespace kinloop
