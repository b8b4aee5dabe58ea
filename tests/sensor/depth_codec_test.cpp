#include "kinloop/sensor/images/depth_codec.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"

namespace kinloop {
namespace {

std::vector<uint16_t> there_and_back(const std::vector<uint16_t>& values) {
  return unpack_depth(pack_depth(values), values.size());
}

TEST(DepthCodec, GivesBackWhatItWasGiven) {
  for (const auto& values : std::vector<std::vector<uint16_t>>{
           {}, {0}, {1}, {65535}, {0, 0, 0}, {5, 5, 5}, {0, 7}, {7, 0}, {65535, 0, 1, 65535, 1}}) {
    EXPECT_EQ(there_and_back(values), values);
  }
}

TEST(DepthCodec, GivesBackNoise) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<uint16_t> values(1 + random.index(5000));
    for (auto& value : values)
      value = random.uniform() < 0.3 ? uint16_t{0} : static_cast<uint16_t>(random.index(65536));
    EXPECT_EQ(there_and_back(values), values);
  }
}

TEST(DepthCodec, MakesSmoothDepthMuchSmaller) {
  Random random(2);
  std::vector<uint16_t> values;
  for (int i = 0; i < 100000; ++i) values.push_back(static_cast<uint16_t>(5000 + i / 50 + random.index(5)));
  EXPECT_LT(pack_depth(values).size(), values.size() * sizeof(uint16_t) / 2);
}

TEST(DepthCodec, RefusesBytesThatItDidNotMake) {
  const std::vector<uint16_t> values(100, 1234);
  auto bytes = pack_depth(values);
  EXPECT_THROW(unpack_depth(bytes, 50), InputError);
  bytes.resize(bytes.size() / 2);
  EXPECT_THROW(unpack_depth(bytes, 100), InputError);
  EXPECT_THROW(unpack_depth(std::vector<uint8_t>(20, 0xff), 100), InputError);
}

}  // namespace
}  // namespace kinloop
