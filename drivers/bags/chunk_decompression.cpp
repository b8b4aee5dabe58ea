#include "drivers/bags/chunk_decompression.hpp"

#include <algorithm>
#include <memory>

#include <bzlib.h>
#include <fmt/format.h>
#include <libdeflate.h>
#include <lz4frame.h>
#include <zstd.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

/// Calls `decode(input, output)`, which consumes bytes from the front of `input` and returns how many bytes
/// it wrote, until `size` bytes are there. Each step may write one megabyte.
template <class Decode>
std::vector<uint8_t> decompress_in_steps(Bytes input, uint64_t size, const Decode& decode) {
  constexpr size_t kStep = size_t{1} << 20;
  std::vector<uint8_t> output;
  size_t written = 0;
  while (written < size) {
    output.resize(std::min<size_t>(static_cast<size_t>(size), std::max(written + kStep, 2 * written)));
    const size_t left = input.size();
    const size_t more = decode(input, std::span(output).subspan(written));
    if (more == 0 && input.size() == left) throw InputError("compressed data are truncated");
    written += more;
  }
  return output;
}

[[noreturn]] void reject_damage(const char* what) {
  throw InputError(fmt::format("compressed data are damaged ({})", what));
}

std::vector<uint8_t> decompressed_lz4(Bytes data, uint64_t size) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      raw, LZ4F_freeDecompressionContext);
  return decompress_in_steps(data, size, [&](Bytes& input, std::span<uint8_t> output) {
    size_t written = output.size(), read = input.size();
    const size_t result = LZ4F_decompress(raw, output.data(), &written, input.data(), &read, nullptr);
    if (LZ4F_isError(result) != 0) reject_damage(LZ4F_getErrorName(result));
    input = input.subspan(read);
    return written;
  });
}

std::vector<uint8_t> decompressed_zstd(Bytes data, uint64_t size) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(require_memory(ZSTD_createDCtx()),
                                                                     ZSTD_freeDCtx);
  return decompress_in_steps(data, size, [&](Bytes& input, std::span<uint8_t> output) {
    ZSTD_inBuffer in{input.data(), input.size(), 0};
    ZSTD_outBuffer out{output.data(), output.size(), 0};
    const size_t result = ZSTD_decompressStream(context.get(), &out, &in);
    if (ZSTD_isError(result) != 0) reject_damage(ZSTD_getErrorName(result));
    input = input.subspan(in.pos);
    return out.pos;
  });
}

std::vector<uint8_t> decompressed_bz2(Bytes data, uint64_t size) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
  const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> closed_at_end(&stream,
                                                                                 BZ2_bzDecompressEnd);
  return decompress_in_steps(data, size, [&](Bytes& input, std::span<uint8_t> output) {
    stream.next_in = reinterpret_cast<char*>(const_cast<uint8_t*>(input.data()));
    stream.avail_in = static_cast<unsigned>(input.size());
    stream.next_out = reinterpret_cast<char*>(output.data());
    stream.avail_out = static_cast<unsigned>(output.size());
    const int result = BZ2_bzDecompress(&stream);
    if (result != BZ_OK && result != BZ_STREAM_END) reject_damage("bz2");
    input = input.last(stream.avail_in);
    return output.size() - stream.avail_out;
  });
}

void require_plausible(uint64_t size) {
  if (size > kMaxBlockBytes)
    throw InputError(
        fmt::format("a compressed block claims {} bytes; at most {} are read", size, kMaxBlockBytes));
}

}  // namespace

std::vector<uint8_t> decompressed(std::string_view compression, Bytes data, uint64_t size) {
  require_plausible(size);
  if (compression == "lz4") return decompressed_lz4(data, size);
  if (compression == "zstd") return decompressed_zstd(data, size);
  if (compression == "bz2") return decompressed_bz2(data, size);
  throw InputError(
      fmt::format("unknown compression '{}'; expected lz4, zstd or bz2", printable(compression)));
}

bool is_zstd(Bytes data) {
  return as_text(data).starts_with("\x28\xb5\x2f\xfd");
}

std::vector<uint8_t> decompressed_zstd_message(Bytes data) {
  const unsigned long long size = ZSTD_getFrameContentSize(data.data(), data.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN)
    throw InputError("a compressed message does not state its size");
  require_plausible(size);
  return decompressed_zstd(data, size);
}

uint32_t crc32(Bytes data) {
  return libdeflate_crc32(0, data.data(), data.size());
}

}  // namespace kinloop
