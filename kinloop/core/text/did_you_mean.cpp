#include "kinloop/core/text/did_you_mean.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kinloop {
namespace {

/// Levenshtein distance, counting a transposition of neighbours as one edit; at least `limit` if it is no
/// less.
size_t edit_distance(std::string_view a, std::string_view b, size_t limit) {
  // Rows i - 2, i - 1 and i of the table of distances between the first i and the first j letters of a and b.
  std::vector<size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    before.swap(last);
    last.swap(row);
    row[0] = i;
    size_t least = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({replaced, last[j] + 1, row[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
      least = std::min(least, row[j]);
    }
    if (least > limit) return least;  // a swap may take one edit less than the rows between
  }
  return row.back();
}

/// Returns the word nearest to `text` if at most every third letter differs; null if there is none.
const std::string* nearest_word(std::string_view text, std::span<const std::string> words) {
  constexpr size_t kLettersPerEdit = 3;
  const std::string* nearest = nullptr;
  size_t fewer_than = std::max(text.size(), kLettersPerEdit) / kLettersPerEdit + 1;
  for (const std::string& word : words) {
    const auto [shorter, longer] = std::minmax({word.size(), text.size()});
    if (longer - shorter >= fewer_than) continue;  // at least as many edits; a text may have megabytes
    const size_t edits = edit_distance(word, text, fewer_than);
    if (edits >= fewer_than) continue;
    nearest = &word;
    fewer_than = edits;
  }
  return nearest;
}

/// Words that end in ".text"; a few at most.
std::vector<std::string> words_ending_in(std::string_view text, std::span<const std::string> words) {
  constexpr size_t kMaxCount = 4;
  std::vector<std::string> found;
  const std::string ending = fmt::format(".{}", text);
  for (const std::string& word : words) {
    if (found.size() < kMaxCount && word.ends_with(ending)) found.push_back(fmt::format("'{}'", word));
  }
  return found;
}

}  // namespace

std::string did_you_mean(std::string_view text, std::span<const std::string> words) {
  if (text.empty()) return {};
  if (const std::string* nearest = nearest_word(text, words))
    return fmt::format("; did you mean '{}'?", *nearest);
  const auto endings = words_ending_in(text, words);
  if (endings.empty()) return {};
  return fmt::format("; did you mean {}?", fmt::join(endings, " or "));
}

}  // namespace kinloop
