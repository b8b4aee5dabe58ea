#include "drivers/datasets/reading/lists/equal_names.hpp"

#include <algorithm>
#include <map>
#include <string>

#include "drivers/datasets/reading/lists/name_times.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

/// The numbers of a name as text: without leading zeros, but with all digits of fractions.
using Numbers = std::vector<std::string>;

Numbers numbers_of(const fs::path& file) {
  Numbers numbers;
  for (NameNumber& number : numbers_in_name(file)) {
    number.digits.erase(0, std::min(number.digits.find_first_not_of('0'), number.digits.size() - 1));
    numbers.push_back(number.fraction.empty() ? number.digits : number.digits + "." + number.fraction);
  }
  return numbers;
}

std::vector<Numbers> numbers_of_all(const std::vector<fs::path>& files) {
  std::vector<Numbers> all;
  for (const fs::path& file : files) all.push_back(numbers_of(file));
  return all;
}

bool have_as_many(const std::vector<Numbers>& names, size_t count) {
  return std::all_of(names.begin(), names.end(), [&](const Numbers& n) { return n.size() == count; });
}

bool is_constant(const std::vector<Numbers>& names, size_t column) {
  return names.size() > 1 && std::all_of(names.begin(), names.end(), [&](const Numbers& n) {
           return n[column] == names.front()[column];
         });
}

/// Leaves of each name the numbers that tell it from others. Both lists keep the same columns where they have
/// as many; else each its own, or only the last one.
void keep_telling_numbers(std::vector<Numbers>& color, std::vector<Numbers>& depth) {
  const size_t count = color.front().size(), depth_count = depth.front().size();
  if (!have_as_many(color, count) || !have_as_many(depth, depth_count)) return;
  const auto keep = [](std::vector<Numbers>& names, size_t columns, const auto& tells) {
    for (Numbers& name : names) {
      Numbers kept;
      for (size_t i = 0; i < columns; ++i) {
        if (tells(i)) kept.push_back(name[i]);
      }
      name = std::move(kept);
    }
  };
  std::vector<bool> color_tells(count), depth_tells(depth_count);
  for (size_t i = 0; i < count; ++i) color_tells[i] = !is_constant(color, i);
  for (size_t i = 0; i < depth_count; ++i) depth_tells[i] = !is_constant(depth, i);
  if (count == depth_count) {
    for (size_t i = 0; i < count; ++i)
      color_tells[i] = depth_tells[i] = color_tells[i] || depth_tells[i] || count == 1;
  }
  keep(color, count, [&](size_t i) { return color_tells[i]; });
  keep(depth, depth_count, [&](size_t i) { return depth_tells[i]; });
}

void keep_last_numbers(std::vector<Numbers>& names) {
  for (Numbers& name : names) {
    if (name.size() > 1) name = {name.back()};
  }
}

std::vector<StampPair> pairs_of(const std::vector<Numbers>& color, const std::vector<Numbers>& depth) {
  std::map<Numbers, size_t> depth_of, color_of;
  for (size_t i = 0; i < depth.size(); ++i) depth_of.emplace(depth[i], i);
  for (size_t i = 0; i < color.size(); ++i) color_of.emplace(color[i], i);
  if (depth_of.size() != depth.size() || color_of.size() != color.size()) return {};
  std::vector<StampPair> pairs;
  for (size_t i = 0; i < color.size(); ++i) {
    const auto found = depth_of.find(color[i]);
    if (found != depth_of.end()) pairs.push_back({i, found->second});
  }
  return pairs;
}

}  // namespace

std::vector<StampPair> pairs_of_equal_names(const std::vector<fs::path>& color,
                                            const std::vector<fs::path>& depth) {
  if (color.empty() || depth.empty()) return {};
  auto color_numbers = numbers_of_all(color), depth_numbers = numbers_of_all(depth);
  keep_telling_numbers(color_numbers, depth_numbers);
  auto pairs = pairs_of(color_numbers, depth_numbers);
  if (!pairs.empty()) return pairs;
  keep_last_numbers(color_numbers);
  keep_last_numbers(depth_numbers);
  return pairs_of(color_numbers, depth_numbers);
}

}  // namespace kinloop
