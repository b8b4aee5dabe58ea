#include "viewer/server/viewer_page.hpp"

#include <memory>

#include <libdeflate.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/embedded_file.hpp"

KINLOOP_EMBED_FILE(embedded_viewer_page, KINLOOP_PAGE)

namespace kinloop {

std::string_view viewer_page() {
  return embedded_viewer_page();
}

std::string gzipped_viewer_page() {
  constexpr int kUsualLevel = 6;
  const std::string_view page = viewer_page();
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      require_memory(libdeflate_alloc_compressor(kUsualLevel)), libdeflate_free_compressor);
  std::string gzip(libdeflate_gzip_compress_bound(compressor.get(), page.size()), '\0');
  gzip.resize(libdeflate_gzip_compress(compressor.get(), page.data(), page.size(), gzip.data(), gzip.size()));
  return gzip;
}

}  // namespace kinloop
