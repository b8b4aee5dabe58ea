#include "kinloop/base/nearest_word.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

namespace kinloop {
namespace {

/// Levenshtein distance.
size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({substituted, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string did_you_mean(std::string_view text, std::span<const std::string> words, size_t max_distance) {
  const auto nearest = std::min_element(words.begin(), words.end(), [&](const auto& a, const auto& b) {
    return edit_distance(a, text) < edit_distance(b, text);
  });
  if (nearest == words.end() || edit_distance(*nearest, text) > max_distance) return {};
  return fmt::format("; did you mean '{}'?", *nearest);
}

}  // namespace kinloop
