#include "drivers/datasets/recorded_source.hpp"

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "drivers/archives/unpacked_archive.hpp"
#include "drivers/datasets/reading/images/depth_image.hpp"
#include "drivers/datasets/reading/images/image_bytes.hpp"
#include "drivers/datasets/reading/lists/frame_masks.hpp"
#include "drivers/image_files/image_file.hpp"
#include "drivers/images/depth_files/depth_formats.hpp"
#include "drivers/images/mask_image.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"

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

/// Same before decoding: a small file may hold a huge image.
void require_encoded_size(const std::string& bytes, const std::filesystem::path& path,
                          const PinholeCamera& camera, const char* remedy) {
  if (const auto size = size_in_header(bytes)) require_size(*size, path, camera, remedy);
}

/// Throws InputError if all files named in a list are missing.
void require_some_there(const std::vector<RecordedFrame>& frames, ImageLocation RecordedFrame::*image,
                        const std::string& name) {
  for (const RecordedFrame& files : frames) {
    std::error_code absent;
    if (std::filesystem::exists((files.*image).file, absent)) return;
  }
  throw InputError(fmt::format("{}: no such file, nor any of the {} listed files; names are relative to {}",
                               (frames.front().*image).file.string(), frames.size(), name));
}

/// Makes depth of the lowest confidence unknown.
void apply_confidence(const std::filesystem::path& file, cv::Mat& depth_m) {
  const cv::Mat confidence = read_confidence_image(file, depth_m.size());
  depth_m.setTo(0, confidence == 0);
}

}  // namespace

RecordedSource::RecordedSource(std::string name, RecordedSequence sequence, const RgbdCamera& camera)
    : camera_(camera), sequence_(std::move(sequence)), prepare_depth_(camera) {
  const auto& frames = sequence_.frames;
  info_.name = std::move(name);
  info_.description = describe(sequence_, camera_);
  info_.frames = frames.size() + sequence_.skipped.size();
  info_.ground_truth = sequence_.ground_truth;
  info_.truth_in_metres = sequence_.truth_in_metres;
  if (!sequence_.video.empty()) video_ = std::make_unique<VideoReader>(sequence_.video);
  if (frames.empty()) return;
  if (!video_) require_some_there(frames, &RecordedFrame::color, info_.name);
  require_some_there(frames, &RecordedFrame::depth, info_.name);
  require_expected_format();
  require_usable_masks(sequence_, {camera_.color.width, camera_.color.height});
}

void RecordedSource::require_expected_format() const {
  constexpr int kFormatCheckFrames =
      3;  // a wrong camera or image format affects every frame, damage only its own
  int wrong = 0;
  std::string first;
  for (const RecordedFrame& files : sequence_.frames) {
    try {
      static_cast<void>(read_images(files));
      return tell_kept_bits(files);
    } catch (const ImageFormatError& error) {
      if (wrong == 0) first = shown(error);
      if (++wrong == kFormatCheckFrames) throw InputError(first);
    } catch (const InputError&) {
      continue;  // next() counts it
    }
  }
}

void RecordedSource::tell_kept_bits(const RecordedFrame& files) const {
  if (video_) return;
  const std::string bytes = read_bytes(files.color);
  if (!is_color_of_16_bits(bytes)) return;
  log::info("{}: colour of 16 bits per channel is reduced to 8", info_.name);
  constexpr double kTwelveBits = 4096;
  double largest = 0;
  cv::minMaxLoc(decode_image(bytes).reshape(1), nullptr, &largest);
  if (largest < kTwelveBits)
    log::warn(
        "{}: no value of {} is above {:.0f}, so that it becomes nearly black; multiply colour of 10 or 12 "
        "bits until it fills 16",
        info_.name, files.color.file.filename().string(), largest);
}

std::optional<Frame> RecordedSource::next() {
  const auto& frames = sequence_.frames;
  auto& skipped = sequence_.skipped;
  while (next_file_ < frames.size()) {
    const RecordedFrame& files = frames[next_file_++];
    try {
      Frame frame = read_images(files);
      frame.depth_m = prepare_depth_(frame.depth_m);
      frame.mask = read_frame_mask(files, {camera_.color.width, camera_.color.height});
      frame.id = FrameId{next_id_++};
      return frame;
    } catch (const MaskFormatError&) {
      throw;  // not damage: without its mask the frame would be used differently than meant
    } catch (const InputError& error) {
      const bool in_video = video_ != nullptr;
      if (first_failure_.empty()) first_failure_ = shown(error);
      skipped.add({(in_video ? files.depth : files.color).file.filename().string(), shown(error)});
    }
  }
  if (next_id_ == 0) {
    if (first_failure_.empty()) throw InputError(fmt::format("{}: no frame to read", info_.name));
    throw InputError(fmt::format("{}: none of the {} frames is usable; the first: {}", info_.name,
                                 info_.frames, first_failure_));
  }
  return std::nullopt;
}

std::string RecordedSource::shown(const std::exception& error) const {
  return sequence_.unpacked ? sequence_.unpacked->shown(error.what()) : error.what();
}

bool RecordedSource::pass_over() {
  if (next_file_ == sequence_.frames.size()) return false;
  ++next_file_;
  return true;
}

Frame RecordedSource::read_images(const RecordedFrame& files) const {
  Frame frame;
  frame.stamp_ns = files.stamp_ns;
  frame.depth_stamp_ns = files.depth_stamp_ns;
  if (video_) {
    frame.color = video_->read(files.video_frame);
    require_size(frame.color.size(), sequence_.video, camera_.color, kColorRemedy);
  } else {
    std::string bytes = read_bytes(files.color);
    require_encoded_size(bytes, files.color.file, camera_.color, kColorRemedy);
    if (const auto turned = turned_by_exif(bytes); !turned.empty())
      throw ImageFormatError(fmt::format("{}: {}", files.color.file.string(), turned));
    frame.color = decode_color_image(std::move(bytes), files.color.file);
  }
  const PinholeCamera& lens = camera_.depth ? *camera_.depth : camera_.color;
  const std::string bytes = read_bytes(files.depth);
  // The size in an archive is known when it is decompressed, which takes as long as decoding it.
  if (has_header(sequence_.depth_encoding) && !is_numpy_archive(bytes))
    require_encoded_size(bytes, files.depth.file, lens, kDepthRemedy);
  frame.depth_m = decode_depth(bytes, files.depth.file, sequence_.depth_encoding, {lens.width, lens.height},
                               camera_.depth_scale);
  require_size(frame.depth_m.size(), files.depth.file, lens, kDepthRemedy);
  if (!files.confidence.empty()) apply_confidence(files.confidence, frame.depth_m);
  return frame;
}

}  // namespace kinloop
