#pragma once

#include <string_view>

namespace kinloop {

/// The page that shows a run (viewer/pages), one HTML file.
std::string_view viewer_page();

}  // namespace kinloop
