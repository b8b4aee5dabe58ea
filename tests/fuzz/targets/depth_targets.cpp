#include <opencv2/core.hpp>

#include "drivers/datasets/reading/images/depth_image.hpp"
#include "drivers/images/encoded_image.hpp"
#include "drivers/openni2/oni_file.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/sensor/images/depth_codec.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace kinloop::fuzz {
namespace {

/// The first byte chooses the encoding, the next two the size; the rest is the image.
struct EncodedDepth {
  int encoding = 0;
  cv::Size size;
  std::string_view bytes;
};

std::optional<EncodedDepth> encoded_depth(std::string_view bytes) {
  constexpr size_t kHeader = 3;
  if (bytes.size() < kHeader) return std::nullopt;
  const auto at = [&](size_t i) { return static_cast<int>(static_cast<uint8_t>(bytes[i])); };
  return EncodedDepth{at(0) % 8, {1 + at(1) % 64, 1 + at(2) % 64}, bytes.substr(kHeader)};
}

cv::Mat decoded(const EncodedDepth& depth) {
  const Bytes bytes = as_bytes(depth.bytes);
  if (depth.encoding == 0) return decode_rvl(bytes, depth.size);
  if (depth.encoding <= 2) return decode_16z(bytes, depth.size, depth.encoding == 2);
  return decode_depth(std::string(depth.bytes), "depth", static_cast<DepthEncoding>(depth.encoding - 3),
                      depth.size, 1000);
}

}  // namespace

void read_depth_encodings_bytes(std::string_view bytes) {
  const auto depth = encoded_depth(bytes);
  if (!depth) return;
  accept([&] {
    const cv::Mat image = decoded(*depth);
    require(!image.empty() && cv::checkRange(image), "depth that is not finite");
  });
}

void read_depth_codec_bytes(std::string_view bytes) {
  const auto depth = encoded_depth(bytes);
  if (!depth) return;
  const auto count = static_cast<size_t>(depth->size.area());
  accept([&] {
    const auto values = unpack_depth(as_bytes(depth->bytes), count);
    require(unpack_depth(pack_depth(values), count) == values, "depth changes when it is packed");
  });
}

}  // namespace kinloop::fuzz
