#pragma once

#include <string_view>

namespace kinloop {

/// Returns the page that shows a run (viewer/pages), one HTML file.
std::string_view viewer_page();

}  // namespace kinloop
