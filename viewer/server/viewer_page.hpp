#pragma once

#include <string>
#include <string_view>

namespace kinloop {

/// Returns the page that shows a run (viewer/pages), one HTML file.
std::string_view viewer_page();

/// Returns the same in gzip format, a quarter of the size.
std::string gzipped_viewer_page();

}  // namespace kinloop
