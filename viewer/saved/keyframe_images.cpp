#include "viewer/saved/keyframe_images.hpp"

#include <string_view>
#include <unordered_map>

#include <opencv2/imgproc.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/io/map_file/map_file.hpp"
#include "kinloop/io/run_folder.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"
#include "viewer/index_by_stamp.hpp"
#include "viewer/saved/saved_map.hpp"

namespace kinloop {
namespace {

std::vector<uint8_t> small_jpeg(const std::vector<uint8_t>& jpeg, const KeyframeImageOptions& options) {
  const std::string_view bytes(reinterpret_cast<const char*>(jpeg.data()), jpeg.size());
  cv::Mat image = decode_jpeg(bytes);
  if (image.empty()) return {};
  if (image.cols > options.width_px) {
    const double scale = static_cast<double>(options.width_px) / image.cols;
    cv::resize(image, image, {}, scale, scale, cv::INTER_AREA);
  }
  return encode_jpeg(image, options.quality);
}

/// The shown keyframes by the frame that each was made of.
std::unordered_map<FrameId, uint32_t> shown_keyframes(const MapData& map, const Trajectory& keyframes,
                                                      size_t most) {
  const auto index_of = index_by_stamp(keyframes);
  const size_t every = (keyframes.size() + most - 1) / most;
  std::unordered_map<FrameId, uint32_t> shown;
  for (const Keyframe& keyframe : map.keyframes) {
    const auto index = index_of.find(keyframe.stamp_ns);
    if (index != index_of.end() && index->second % every == 0) shown.emplace(keyframe.frame, index->second);
  }
  return shown;
}

}  // namespace

std::vector<KeyframeImage> read_keyframe_images(const std::filesystem::path& map_file,
                                                const Trajectory& keyframes,
                                                const KeyframeImageOptions& options) {
  std::vector<KeyframeImage> images;
  if (keyframes.empty()) return images;
  const MapReader reader(map_file);
  const auto shown = shown_keyframes(reader.read().first.map, keyframes, options.most);
  reader.read_images([&](const SavedImages& saved) {
    const auto keyframe = shown.find(saved.frame);
    if (keyframe == shown.end()) return;
    if (auto jpeg = small_jpeg(saved.images.color, options); !jpeg.empty())
      images.push_back(KeyframeImage{keyframe->second, std::move(jpeg)});
  });
  return images;
}

std::vector<KeyframeImage> keyframe_images_of(const std::filesystem::path& shown, const Trajectory& keyframes,
                                              const KeyframeImageOptions& options) {
  const auto map = is_map_file(shown) ? shown : shown / kMapFileName;
  if (!std::filesystem::exists(map)) return {};
  try {
    return read_keyframe_images(map, keyframes, options);
  } catch (const InputError& error) {
    log::warn("the images of keyframes are not shown: {}", error.what());
    return {};
  }
}

std::vector<EncodedPart> encode_keyframe_images(std::vector<KeyframeImage> images) {
  std::vector<EncodedPart> parts;
  for (KeyframeImage& image : images)
    parts.push_back({PartKind::kKeyframeImage, image.keyframe, std::move(image.jpeg)});
  return parts;
}

}  // namespace kinloop
