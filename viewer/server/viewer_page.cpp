#include "viewer/server/viewer_page.hpp"

#include "kinloop/core/files/embedded_file.hpp"

KINLOOP_EMBED_FILE(embedded_viewer_page, KINLOOP_PAGE)

namespace kinloop {

std::string_view viewer_page() {
  return embedded_viewer_page();
}

}  // namespace kinloop
