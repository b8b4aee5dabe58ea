// XML as camera files use it: OpenCV's FileStorage and Agisoft Metashape.

#include <charconv>
#include <sstream>

#include "drivers/datasets/camera_files/camera_formats.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

/// The text of an element: a number, a list of numbers, or the text itself.
json value_of(const std::string& text) {
  std::istringstream words(text);
  json numbers = json::array();
  for (std::string word; words >> word;) {
    double number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size()) return text;
    numbers.push_back(number);
  }
  if (numbers.empty()) return text;
  return numbers.size() == 1 ? numbers.front() : numbers;
}

class XmlReader {
 public:
  explicit XmlReader(std::string_view text) : text_(text) {}

  /// The elements up to the end tag of the one that holds them, or the end of the file; nullopt if damaged.
  std::optional<json> content(const std::string& name, int depth) {
    constexpr int kDeepest = 16;
    if (depth > kDeepest) return std::nullopt;
    json object = json::object();
    std::string text;
    while (at_ < text_.size()) {
      if (text_[at_] != '<') {
        text += text_[at_++];
        continue;
      }
      const size_t end = text_.find('>', at_);
      if (end == std::string_view::npos) return std::nullopt;
      const std::string_view tag = text_.substr(at_ + 1, end - at_ - 1);
      at_ = end + 1;
      if (tag.starts_with('?') || tag.starts_with('!')) continue;
      if (tag.starts_with('/')) {
        if (tag.substr(1) != name) return std::nullopt;
        return object.empty() ? value_of(text) : object;
      }
      const std::string child(tag.substr(0, tag.find_first_of(" \t\r\n/")));
      const auto value = tag.ends_with('/') ? json() : content(child, depth + 1);
      if (!value) return std::nullopt;
      object.emplace(child, *value);  // of several elements of a name, the first
    }
    return name.empty() ? std::optional(object) : std::nullopt;
  }

 private:
  std::string_view text_;
  size_t at_ = 0;
};

}  // namespace

std::optional<json> parse_camera_xml(std::string_view text) {
  auto all = XmlReader(text).content("", 0);
  // The root element has no meaning of its own.
  if (all && all->is_object() && all->size() == 1 && all->begin()->is_object()) return json(*all->begin());
  return all;
}

}  // namespace kinloop
