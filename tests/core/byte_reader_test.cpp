#include "kinloop/core/files/byte_reader.hpp"

#include <gtest/gtest.h>

namespace kinloop {
namespace {

using namespace std::string_view_literals;

TEST(ByteReader, ReadsLittleEndianNumbersBlocksAndStringsInTurn) {
  const auto bytes = "\x01\x02\xff\xff\xff\xff\0\0\x80\x3f\x03\0\0\0a\nb!"sv;
  ByteReader reader(as_bytes(bytes));
  EXPECT_EQ(reader.number<uint16_t>(), 0x0201);
  EXPECT_EQ(reader.number<int32_t>(), -1);
  EXPECT_EQ(reader.number<float>(), 1.0F);
  EXPECT_EQ(reader.string(), "a?b");
  EXPECT_EQ(as_text(reader.block(1)), "!");
  EXPECT_EQ(reader.left(), 0U);
}

TEST(ByteReader, AtTheEndItThrowsAndStays) {
  ByteReader reader(as_bytes("\x05\0\0"sv));
  EXPECT_THROW(reader.number<uint32_t>(), InputError);
  EXPECT_THROW(reader.block(uint64_t{1} << 40), InputError);
  EXPECT_EQ(reader.number<uint16_t>(), 5);
}

TEST(ByteReader, BigEndianNumbersBeginWithTheirHighestByte) {
  const auto bytes = "\0\x01\x02\xf3\xf4\0"sv;
  EXPECT_EQ(big_endian_at<uint16_t>(bytes, 1), 0x0102);
  EXPECT_EQ(big_endian_at<uint32_t>(bytes, 1), 0x0102f3f4U);
  EXPECT_EQ(big_endian_at<uint32_t>(bytes, 2), byte_swapped(uint32_t{0x00f4f302}));
}

}  // namespace
}  // namespace kinloop
