#include "viewer/gzip.hpp"

#include <memory>

#include <libdeflate.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {

std::string gzipped(std::string_view bytes) {
  constexpr int kUsualLevel = 6;
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      require_memory(libdeflate_alloc_compressor(kUsualLevel)), libdeflate_free_compressor);
  std::string gzip(libdeflate_gzip_compress_bound(compressor.get(), bytes.size()), '\0');
  gzip.resize(
      libdeflate_gzip_compress(compressor.get(), bytes.data(), bytes.size(), gzip.data(), gzip.size()));
  return gzip;
}

}  // namespace kinloop
