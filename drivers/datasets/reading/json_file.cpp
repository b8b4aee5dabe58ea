#include "drivers/datasets/reading/json_file.hpp"

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/text/json.hpp"

namespace kinloop {

nlohmann::json read_json(const std::filesystem::path& file) {
  constexpr uint64_t kMostBytes = uint64_t{64} << 20;  // values take ten times as much
  require_size(file, kMostBytes);
  const std::string text = read_file(file);
  if (is_nested_too_deeply(text))
    throw InputError(fmt::format("{}: more than {} brackets are open at once; copy it again", file.string(),
                                 kMaxJsonDepth));
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    throw InputError(
        fmt::format("{}: not JSON: wrong or cut off at byte {}; copy it again", file.string(), error.byte));
  } catch (const nlohmann::json::exception&) {  // e.g. a number out of range
    throw InputError(fmt::format("{}: not JSON; copy it again", file.string()));
  }
}

double number_at(const nlohmann::json& object, const std::string& key, const std::filesystem::path& file) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  if (found == object.end() || !found->is_number())
    throw InputError(fmt::format("{}: no number '{}'; add it", file.string(), key));
  return found->get<double>();
}

std::vector<double> numbers_at(const nlohmann::json& object, const std::string& key, size_t least,
                               const std::filesystem::path& file) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  std::vector<double> numbers;
  if (found != object.end() && found->is_array()) {
    for (const auto& value : *found) {
      if (value.is_number()) numbers.push_back(value.get<double>());
    }
  }
  if (numbers.size() < least)
    throw InputError(
        fmt::format("{}: '{}' is not a list of {} numbers; correct the file", file.string(), key, least));
  return numbers;
}

}  // namespace kinloop
