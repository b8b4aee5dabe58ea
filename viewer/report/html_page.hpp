#pragma once
// A static page of figures and tables without scripts, for pose graphs and calibrations, and how it is
// filled. (The report of a run is a separate page, in viewer/.)

#include <map>
#include <string>
#include <string_view>

namespace kinloop {

/// Template with the placeholders {{title}}, {{subtitle}} and {{body}}.
extern const char* const kHtmlPage;

/// Formats an integer with a thin space between thousands.
std::string format_with_thousands(double number);

/// Replaces each {{name}} in `page` by its value, unknown names by nothing; values are not escaped.
std::string fill_template(std::string_view page,
                          const std::map<std::string, std::string, std::less<>>& values);

}  // namespace kinloop
