#include "tools/vocabulary_training/descriptors/training_set.hpp"

#include "kinloop/core/errors.hpp"

namespace kinloop {

void TrainingSet::append(const cv::Mat& descriptors) {
  if (descriptors.empty()) return;
  const size_t bytes = descriptor_traits(kind).bytes;
  require(descriptors.type() == CV_8UC1 && static_cast<size_t>(descriptors.cols) == bytes,
          "the descriptors are of another kind than the training set's");
  for (int row = 0; row < descriptors.rows; ++row) {
    rows.insert(rows.end(), descriptors.ptr(row), descriptors.ptr(row) + bytes);
  }
  image_of.insert(image_of.end(), static_cast<size_t>(descriptors.rows), images);
  ++images;
}

TrainingSet to_training_set(std::span<const cv::Mat> descriptors_of_images, DescriptorKind kind) {
  TrainingSet set(kind);
  for (const cv::Mat& descriptors : descriptors_of_images) set.append(descriptors);
  return set;
}

}  // namespace kinloop
