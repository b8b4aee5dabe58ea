#pragma once
// In: folders, image files and sequences. Out: the images in them and their descriptors.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/base/progress.hpp"
#include "kinloop/features/options.hpp"

namespace kinloop {

/// All images named by `inputs`: a file stands for itself, a folder with an rgb.txt (TUM layout) for the
/// images listed there, any other folder for every image file in it and below, in the order of their names.
/// Throws InputError when an input does not exist or a folder holds no image.
std::vector<std::filesystem::path> list_images(std::span<const std::filesystem::path> inputs);

struct ImageDescriptors {
  std::vector<cv::Mat> of_images;                 ///< of those that could be read, N x 32 bytes each
  std::vector<std::filesystem::path> unreadable;  ///< skipped
};

/// Descriptors of each image, of the kind that `options` says; unreadable ones are skipped and named. Stops
/// early when `progress` says so.
ImageDescriptors describe_images(std::span<const std::filesystem::path> images, const FeatureOptions& options,
                                 int threads, const Progress& progress = {});

}  // namespace kinloop
