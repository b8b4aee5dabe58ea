#pragma once
// Text helpers for HTML pages.

#include <map>
#include <string>
#include <string_view>

namespace kinloop {

/// Formats an integer with a thin space between thousands.
std::string format_with_thousands(double number);

/// Replaces each {{name}} in `page` by its value, unknown names by nothing; values are not escaped.
std::string fill_template(std::string_view page,
                          const std::map<std::string, std::string, std::less<>>& values);

}  // namespace kinloop
