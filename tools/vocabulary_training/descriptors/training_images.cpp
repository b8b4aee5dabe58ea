#include "tools/vocabulary_training/descriptors/training_images.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>
#include <opencv2/features2d.hpp>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/text/lower_case.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/features/extraction/extractor.hpp"
#include "kinloop/features/extraction/surf.hpp"
#include "kinloop/sensor/sensor.hpp"
#include "tools/vocabulary_training/descriptors/descriptor_file.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

bool is_image_name(const fs::path& path) {
  static constexpr std::array kExtensions = {".png", ".jpg", ".jpeg"};
  const std::string extension = lower_case(path.extension().string());
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

std::vector<fs::path> images_of_sequence(const fs::path& folder) {
  std::vector<fs::path> images;
  for (const auto& line : read_table(folder / "rgb.txt")) {
    if (line.fields.size() < 2)
      throw_parse_error(folder / "rgb.txt", line.number, "expected 'timestamp filename'");
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

/// SIFT components are integers up to 255; SURF vectors have length 1, with components mostly below 0.5.
cv::Mat float_descriptors_as_bytes(const cv::Mat& gray, const DescribeOptions& description) {
  cv::Mat descriptors, bytes;
  if (description.kind == DescriptorKind::kSift) {
    std::vector<cv::KeyPoint> keypoints;
    cv::SIFT::create(description.features.count)
        ->detectAndCompute(gray, cv::noArray(), keypoints, descriptors);
    descriptors.convertTo(bytes, CV_8U);
  } else {
    constexpr double kSteps = 255, kMiddle = 128;
    detect_surf(gray, description.features.count).descriptors.convertTo(bytes, CV_8U, kSteps, kMiddle);
  }
  return bytes;
}

std::optional<cv::Mat> gray_if_readable(const fs::path& path) {
  try {
    return read_color_image(path).gray();
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// This process's share [first, second) of `count` items.
std::pair<size_t, size_t> share_of(size_t count, const Communicator& communicator) {
  const auto rank = static_cast<size_t>(communicator.rank()), size = static_cast<size_t>(communicator.size());
  return {count * rank / size, count * (rank + 1) / size};
}

void require_kind(const DescriptorFile& file, const fs::path& path, DescriptorKind kind) {
  if (file.kind() == kind) return;
  throw InputError(fmt::format("{}: descriptors of {}, expected {}; see --feature and --euclidean",
                               path.string(), descriptor_traits(file.kind()).name,
                               descriptor_traits(kind).name));
}

}  // namespace

TrainingInput list_training_input(std::span<const fs::path> inputs) {
  TrainingInput listed;
  for (const auto& input : inputs) {
    if (!fs::exists(input)) throw InputError(fmt::format("{}: no such file or folder", input.string()));
    if (!fs::is_directory(input)) {
      (input.extension() == ".kindesc" ? listed.descriptor_files : listed.images).push_back(input);
      continue;
    }
    const auto inside = fs::exists(input / "rgb.txt") ? images_of_sequence(input) : images_below(input);
    if (inside.empty()) throw InputError(fmt::format("{}: no image in this folder", input.string()));
    listed.images.insert(listed.images.end(), inside.begin(), inside.end());
  }
  return listed;
}

std::optional<cv::Mat> describe_image(const fs::path& path, const DescribeOptions& description) {
  const auto gray_image = gray_if_readable(path);
  if (!gray_image) return std::nullopt;
  const cv::Mat& gray = *gray_image;
  if (descriptor_traits(description.kind).metric == Metric::kEuclidean) {
    return float_descriptors_as_bytes(gray, description);
  }
  PinholeCamera camera;  // only pixels matter here; any undistorted camera will do
  camera.width = gray.cols;
  camera.height = gray.rows;
  camera.fx = camera.fy = gray.cols;
  camera.cx = 0.5 * gray.cols;
  camera.cy = 0.5 * gray.rows;
  return extract_features(gray, cv::Mat(), Sensor{camera}, description.features).descriptors;
}

void describe_images(std::span<const fs::path> images, const DescribeOptions& description,
                     const Progress& progress,
                     const std::function<void(const fs::path&, const std::optional<cv::Mat>&)>& visit) {
  constexpr size_t kBatch = 16;  // images between progress reports
  for (size_t begin = 0; begin < images.size(); begin += kBatch) {
    if (!report(progress, "describing", begin, images.size())) return;
    const auto batch = images.subspan(begin, std::min(kBatch, images.size() - begin));
    std::vector<std::optional<cv::Mat>> described(batch.size());
    parallel_for(batch.size(), description.threads, [&](size_t first, size_t last) {
      for (size_t i = first; i < last; ++i) described[i] = describe_image(batch[i], description);
    });
    for (size_t i = 0; i < batch.size(); ++i) visit(batch[i], described[i]);
  }
  report(progress, "describing", images.size(), images.size());
}

LoadedTrainingSet read_training_set(const TrainingInput& input, const DescribeOptions& description,
                                    const Progress& progress, const Communicator& communicator,
                                    std::pmr::memory_resource* memory) {
  LoadedTrainingSet described{TrainingSet(description.kind, memory), {}};
  const auto [begin, end] = share_of(input.images.size(), communicator);
  describe_images(std::span(input.images).subspan(begin, end - begin), description, progress,
                  [&](const fs::path& path, const std::optional<cv::Mat>& descriptors) {
                    if (descriptors) {
                      described.set.append(*descriptors);
                    } else {
                      described.unreadable.push_back(path);
                    }
                  });
  for (const fs::path& path : input.descriptor_files) {
    DescriptorFile file(path);
    require_kind(file, path, description.kind);
    const auto [first, last] = share_of(file.images(), communicator);
    for (size_t image = first; image < last; ++image) described.set.append(file.descriptors_of_image(image));
  }
  return described;
}

}  // namespace kinloop
