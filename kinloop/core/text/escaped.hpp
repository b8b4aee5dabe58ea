#pragma once
// Text that is safe to print on a terminal or in a page: a path or a name in a file may hold any bytes.

#include <string>
#include <string_view>

namespace kinloop {

/// Returns the text with its control characters escaped as in C, "\x1b": those of ASCII, the ones of Unicode
/// that terminals obey (U+0080 to U+009F) or that reverse the direction of writing (U+202E), and all bytes
/// that are not UTF-8. Characters of `kept` stay as they are.
std::string escaped(std::string_view text, std::string_view kept = {});

/// Returns the text as content or attribute of HTML and XML (SVG), without the control characters that XML
/// forbids.
std::string escaped_markup(std::string_view text);

}  // namespace kinloop
