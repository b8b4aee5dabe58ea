#include "viewer/keyframe_images.hpp"

#include <string_view>
#include <unordered_map>

#include <opencv2/imgproc.hpp>

#include "kinloop/io/map_file/map_file.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"
#include "viewer/index_by_stamp.hpp"

namespace kinloop {
namespace {

constexpr size_t kMostImages = 500;
constexpr int kWidthPx = 320;
constexpr int kQuality = 80;

std::vector<uint8_t> small_jpeg(const std::vector<uint8_t>& jpeg) {
  const std::string_view bytes(reinterpret_cast<const char*>(jpeg.data()), jpeg.size());
  cv::Mat image = decode_jpeg(bytes);
  if (image.empty()) return {};
  if (image.cols > kWidthPx) {
    const double scale = static_cast<double>(kWidthPx) / image.cols;
    cv::resize(image, image, {}, scale, scale, cv::INTER_AREA);
  }
  return encode_jpeg(image, kQuality);
}

/// The shown keyframes by the frame that each was made of.
std::unordered_map<FrameId, uint32_t> shown_keyframes(const MapData& map, const Trajectory& keyframes) {
  const auto index_of = index_by_stamp(keyframes);
  const size_t every = (keyframes.size() + kMostImages - 1) / kMostImages;
  std::unordered_map<FrameId, uint32_t> shown;
  for (const Keyframe& keyframe : map.keyframes) {
    const auto index = index_of.find(keyframe.stamp_ns);
    if (index != index_of.end() && index->second % every == 0) shown.emplace(keyframe.frame, index->second);
  }
  return shown;
}

}  // namespace

std::vector<KeyframeImage> read_keyframe_images(const std::filesystem::path& map_file,
                                                const Trajectory& keyframes) {
  std::vector<KeyframeImage> images;
  if (keyframes.empty()) return images;
  const MapReader reader(map_file);
  const auto shown = shown_keyframes(reader.read().first.map, keyframes);
  reader.read_images([&](const SavedImages& saved) {
    const auto keyframe = shown.find(saved.frame);
    if (keyframe == shown.end()) return;
    if (auto jpeg = small_jpeg(saved.images.color); !jpeg.empty())
      images.push_back(KeyframeImage{keyframe->second, std::move(jpeg)});
  });
  return images;
}

}  // namespace kinloop
