#include <algorithm>
#include <cmath>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"
#include "tools/export/sparse_model/sparse_model.hpp"

namespace kinloop {
namespace {

constexpr double kDepthUnitsPerM = 1000;

/// Colours of an image at its observations.
using Colors = std::vector<Rgb>;

Colors colors_at(const cv::Mat& bgr, const ModelImage& image) {
  Colors colors;
  for (const ModelObservation& observation : image.observations) {
    const int col = std::clamp(static_cast<int>(std::lround(observation.pixel.x())), 0, bgr.cols - 1);
    const int row = std::clamp(static_cast<int>(std::lround(observation.pixel.y())), 0, bgr.rows - 1);
    const auto& pixel = bgr.at<cv::Vec3b>(row, col);
    colors.push_back({pixel[2], pixel[1], pixel[0]});
  }
  return colors;
}

Colors write_image(const std::filesystem::path& folder, const ModelImage& image, const ImageStore& store,
                   const ImageUndistorter& undistorter, bool with_depth) {
  EncodedImages encoded = store.encoded(image.stored);
  const RgbdImages raw = decode_images(encoded, store.encoding());
  const bool resample = !undistorter.is_identity();
  const cv::Mat raw_pixels = resample || with_depth ? undistorter.raw_pixels(image.velocity) : cv::Mat();
  const cv::Mat color = resample ? undistorter.color(raw.color, raw_pixels) : raw.color;
  const auto jpeg = resample ? encode_jpeg(color, store.encoding().jpeg_quality) : std::move(encoded.color);
  write_file(folder / "images" / (image.name + ".jpg"),
             {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()}, Durability::kWithTheOthers);
  if (with_depth) {
    write_depth_png(folder / "depth" / (image.name + ".png"), undistorter.depth(raw.depth_m, raw_pixels),
                    kDepthUnitsPerM);
  }
  return colors_at(color, image);
}

/// Sets the colour of each landmark to the mean of its observations.
void set_colors(SparseModel& model, const std::vector<Colors>& colors) {
  for (ModelPoint& point : model.points) {
    if (point.track.empty()) continue;
    for (size_t channel = 0; channel < point.color.size(); ++channel) {
      size_t sum = point.track.size() / 2;  // rounds
      for (const auto& [image, observation] : point.track) sum += colors[image][observation][channel];
      point.color[channel] = static_cast<uint8_t>(sum / point.track.size());
    }
  }
}

}  // namespace

void write_model_images(const std::filesystem::path& folder, SparseModel& model, const ImageStore& store,
                        const ImageUndistorter& undistorter, const ModelImageOptions& options,
                        const Progress& progress) {
  make_folder(folder / "images");
  if (options.depth) make_folder(folder / "depth");
  std::vector<Colors> colors(model.images.size());
  const auto batch = static_cast<size_t>(std::max(options.threads, 1)) * 4;
  for (size_t first = 0; first < colors.size(); first += batch) {
    const size_t count = std::min(batch, colors.size() - first);
    parallel_for(count, options.threads, [&](size_t begin, size_t end) {
      for (size_t i = first + begin; i < first + end; ++i)
        colors[i] = write_image(folder, model.images[i], store, undistorter, options.depth);
    });
    report(progress, "images", first + count, colors.size());
  }
  flush_files(folder);
  set_colors(model, colors);
}

}  // namespace kinloop
