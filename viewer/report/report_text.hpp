#pragma once
// Small pieces of text that a page is put together from.

#include <map>
#include <string>
#include <string_view>

namespace kinloop {

/// The text with the characters that mean something in HTML written out.
std::string escape_html(std::string_view text);

/// RFC 4648.
std::string base64(std::string_view bytes);

/// A whole number with a thin space between thousands.
std::string format_with_thousands(double number);

/// `page` with each {{name}} replaced by its value, names without one by nothing; values are taken as they
/// are.
std::string fill_template(std::string_view page,
                          const std::map<std::string, std::string, std::less<>>& values);

}  // namespace kinloop
