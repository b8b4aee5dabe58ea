#include "viewer/report/report_text.hpp"

#include <cmath>

namespace kinloop {

std::string format_with_thousands(double number) {
  constexpr size_t kGroup = 3;
  std::string digits = std::to_string(std::llround(std::abs(number)));
  for (size_t at = digits.size(); at > kGroup; at -= kGroup) digits.insert(at - kGroup, "&#8239;");
  return (number < 0 ? "-" : "") + digits;
}

std::string fill_template(std::string_view page,
                          const std::map<std::string, std::string, std::less<>>& values) {
  constexpr std::string_view kOpen = "{{", kClose = "}}";
  std::string filled;
  while (true) {
    const size_t open = page.find(kOpen);
    const size_t close = page.find(kClose, open);
    filled += page.substr(0, open);
    if (open == std::string_view::npos || close == std::string_view::npos) return filled;
    const auto value = values.find(page.substr(open + kOpen.size(), close - open - kOpen.size()));
    if (value != values.end()) filled += value->second;
    page.remove_prefix(close + kClose.size());
  }
}

}  // namespace kinloop
