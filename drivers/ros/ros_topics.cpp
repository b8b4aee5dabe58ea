#include "drivers/ros/ros_topics.hpp"

#include <vector>

#include <fmt/format.h>

#include "kinloop/base/errors.hpp"

namespace kinloop {

RosTopics parse_topics(std::string_view text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  bool usable = parts.size() == 2 || parts.size() == 3;
  for (const auto& part : parts) usable = usable && part.size() > 1 && part.front() == '/';
  if (!usable) {
    throw UsageError(fmt::format("--topics: '{}' is not COLOR,DEPTH[,CAMERA_INFO], e.g. {},{}", text,
                                 known_topics()[0].color, known_topics()[0].depth));
  }
  const std::string& color = parts[0];
  return {color, parts[1], parts.size() == 3 ? parts[2] : color.substr(0, color.rfind('/')) + "/camera_info"};
}

}  // namespace kinloop
