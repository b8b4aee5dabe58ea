#include "kinloop/place/training_images.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/parallel_for.hpp"
#include "kinloop/base/text_file.hpp"
#include "kinloop/features/extractor.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

bool is_image_name(const fs::path& path) {
  static constexpr std::array kExtensions = {".png", ".jpg", ".jpeg", ".bmp", ".pgm",
                                             ".ppm", ".tif", ".tiff", ".webp"};
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

std::vector<fs::path> images_of_sequence(const fs::path& folder) {
  std::vector<fs::path> images;
  for (const auto& line : read_table(folder / "rgb.txt")) {
    if (line.fields.size() < 2) throw_at(folder / "rgb.txt", line.number, "expected 'timestamp filename'");
    images.push_back(folder / line.fields[1]);
  }
  return images;
}

std::vector<fs::path> images_below(const fs::path& folder) {
  std::vector<fs::path> images;
  for (const auto& entry :
       fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied)) {
    if (entry.is_regular_file() && is_image_name(entry.path())) images.push_back(entry.path());
  }
  std::sort(images.begin(), images.end());
  return images;
}

/// Nothing when the file is not an image.
std::optional<cv::Mat> describe_image(const fs::path& path, const FeatureOptions& options) {
  cv::Mat gray;
  try {
    gray = cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception&) {  // a header that claims an absurd size
    return std::nullopt;
  }
  if (gray.empty()) return std::nullopt;
  PinholeCamera camera;  // pixels alone matter here: any camera without distortion will do
  camera.width = gray.cols;
  camera.height = gray.rows;
  camera.fx = camera.fy = gray.cols;
  camera.cx = 0.5 * gray.cols;
  camera.cy = 0.5 * gray.rows;
  return extract_features(gray, cv::Mat(), camera, options).descriptors;
}

}  // namespace

std::vector<fs::path> list_images(std::span<const fs::path> inputs) {
  std::vector<fs::path> images;
  for (const auto& input : inputs) {
    if (!fs::exists(input)) throw InputError(fmt::format("{}: no such file or folder", input.string()));
    if (!fs::is_directory(input)) {
      images.push_back(input);
      continue;
    }
    const auto inside = fs::exists(input / "rgb.txt") ? images_of_sequence(input) : images_below(input);
    if (inside.empty()) throw InputError(fmt::format("{}: no image in this folder", input.string()));
    images.insert(images.end(), inside.begin(), inside.end());
  }
  return images;
}

ImageDescriptors describe_images(std::span<const fs::path> images, const FeatureOptions& options, int threads,
                                 const Progress& progress) {
  constexpr size_t kBatch = 16;  // images between two reports
  ImageDescriptors result;
  for (size_t begin = 0; begin < images.size(); begin += kBatch) {
    if (!report(progress, "describing images", begin, images.size())) break;
    const auto batch = images.subspan(begin, std::min(kBatch, images.size() - begin));
    std::vector<std::optional<cv::Mat>> described(batch.size());
    parallel_for(batch.size(), threads, [&](size_t first, size_t last) {
      for (size_t i = first; i < last; ++i) described[i] = describe_image(batch[i], options);
    });
    for (size_t i = 0; i < batch.size(); ++i) {
      if (described[i]) {
        result.of_images.push_back(std::move(*described[i]));
      } else {
        result.unreadable.push_back(batch[i]);
      }
    }
  }
  return result;
}

}  // namespace kinloop
