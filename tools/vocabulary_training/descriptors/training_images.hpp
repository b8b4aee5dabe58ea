#pragma once
// In: folders, image files, sequences and descriptor files. Out: their descriptors.

#include <filesystem>
#include <functional>
#include <memory_resource>
#include <optional>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/progress.hpp"
#include "kinloop/features/options.hpp"
#include "tools/vocabulary_training/communicator.hpp"
#include "tools/vocabulary_training/descriptors/training_set.hpp"

namespace kinloop {

/// The inputs of a training.
struct TrainingInput {
  std::vector<std::filesystem::path> images;
  std::vector<std::filesystem::path> descriptor_files;  ///< .kindesc
};

/// Lists the training data named by `inputs`: a file stands for itself, a folder with an rgb.txt (TUM layout)
/// for the images listed there, any other folder for all image files in it and below, sorted by name. Throws
/// InputError if an input does not exist or a folder holds no image.
TrainingInput list_training_input(std::span<const std::filesystem::path> inputs);

/// How descriptors are computed.
struct DescribeOptions {
  FeatureOptions features = {};
  DescriptorKind kind = DescriptorKind::kOrb;  ///< of `features`
  int threads = 1;
};

/// Returns the descriptors of an image file; nullopt if it is not an image.
std::optional<cv::Mat> describe_image(const std::filesystem::path& path, const DescribeOptions& description);

/// Calls `visit` for each image in order, with nullopt for unreadable ones. Stops early if `progress` says
/// so.
void describe_images(
    std::span<const std::filesystem::path> images, const DescribeOptions& description,
    const Progress& progress,
    const std::function<void(const std::filesystem::path&, const std::optional<cv::Mat>&)>& visit);

/// A training set, and the images skipped.
struct LoadedTrainingSet {
  TrainingSet set;
  std::vector<std::filesystem::path> unreadable;
};

/// Reads the descriptors of this process's share of the images, which follows that of the previous process.
/// Throws InputError if a descriptor file is of another kind.
LoadedTrainingSet read_training_set(const TrainingInput& input, const DescribeOptions& description,
                                    const Progress& progress = {},
                                    const Communicator& communicator = Communicator(),
                                    std::pmr::memory_resource* memory = std::pmr::get_default_resource());

}  // namespace kinloop
