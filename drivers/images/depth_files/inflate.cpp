#include "drivers/images/depth_files/inflate.hpp"

#include <memory>

#include <libdeflate.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/images/image_limits.hpp"

namespace kinloop {
namespace {

using Decompress = decltype(&libdeflate_zlib_decompress);

std::string inflate_with(Decompress decompress, std::string_view bytes, size_t size) {
  using Decompressor = std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)>;
  if (size / kMaxInflation > bytes.size()) throw InputError("a compressed block is truncated");
  const Decompressor decompressor(require_memory(libdeflate_alloc_decompressor()),
                                  libdeflate_free_decompressor);
  std::string content(size, '\0');
  const auto result =
      decompress(decompressor.get(), bytes.data(), bytes.size(), content.data(), content.size(), nullptr);
  if (result != LIBDEFLATE_SUCCESS)
    throw InputError("a compressed block is damaged, or of another size than the header says");
  return content;
}

}  // namespace

std::string inflate_zlib(std::string_view bytes, size_t size) {
  return inflate_with(libdeflate_zlib_decompress, bytes, size);
}

std::string inflate_raw(std::string_view bytes, size_t size) {
  return inflate_with(libdeflate_deflate_decompress, bytes, size);
}

}  // namespace kinloop
