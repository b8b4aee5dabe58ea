#include "kinloop/place/binary_descriptor.hpp"

#include <cstring>

#include "kinloop/base/errors.hpp"

namespace kinloop {

std::vector<BinaryDescriptor> to_binary_descriptors(const cv::Mat& descriptors) {
  if (descriptors.empty()) return {};
  require(descriptors.type() == CV_8UC1 && descriptors.cols == kOrbBytes,
          "a binary dictionary takes descriptors of 32 bytes a row (ORB)");
  std::vector<BinaryDescriptor> rows(static_cast<size_t>(descriptors.rows));
  for (int row = 0; row < descriptors.rows; ++row) {
    std::memcpy(rows[static_cast<size_t>(row)].data(), descriptors.ptr(row), kOrbBytes);
  }
  return rows;
}

}  // namespace kinloop
