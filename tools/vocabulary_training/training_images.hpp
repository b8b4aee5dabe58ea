#pragma once
// In: folders, image files, sequences and files of descriptors. Out: the descriptors in them.

#include <filesystem>
#include <functional>
#include <memory_resource>
#include <optional>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/base/progress.hpp"
#include "kinloop/features/options.hpp"
#include "tools/vocabulary_training/communicator.hpp"
#include "tools/vocabulary_training/training_set.hpp"

namespace kinloop {

/// What there is to train on.
struct TrainingInput {
  std::vector<std::filesystem::path> images;
  std::vector<std::filesystem::path> descriptor_files;  ///< .kindesc
};

/// What is named by `inputs`: a file stands for itself, a folder with an rgb.txt (TUM layout) for the images
/// listed there, any other folder for every image file in it and below, in the order of their names. Throws
/// InputError when an input does not exist or a folder holds no image.
TrainingInput list_training_input(std::span<const std::filesystem::path> inputs);

/// How images are described.
struct DescribeOptions {
  FeatureOptions features = {};
  DescriptorKind kind = DescriptorKind::kOrb;  ///< of `features`
  int threads = 1;
};

/// The descriptors of a file, nothing when it is not an image.
std::optional<cv::Mat> describe_image(const std::filesystem::path& path, const DescribeOptions& description);

/// Calls `visit` for each image in order, with nothing for those that cannot be read. Stops early when
/// `progress` says so.
void describe_images(
    std::span<const std::filesystem::path> images, const DescribeOptions& description,
    const Progress& progress,
    const std::function<void(const std::filesystem::path&, const std::optional<cv::Mat>&)>& visit);

/// A training set, and what was left out of it.
struct LoadedTrainingSet {
  TrainingSet set;
  std::vector<std::filesystem::path> unreadable;
};

/// The descriptors of this process's share of the images, which follows that of the process before it. Throws
/// InputError for a file of descriptors of another kind.
LoadedTrainingSet read_training_set(const TrainingInput& input, const DescribeOptions& description,
                                    const Progress& progress = {},
                                    const Communicator& communicator = Communicator(),
                                    std::pmr::memory_resource* memory = std::pmr::get_default_resource());

}  // namespace kinloop
