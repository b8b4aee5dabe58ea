#pragma once
// Which word was meant by one that nothing has as its name.

#include <limits>
#include <span>
#include <string>
#include <string_view>

namespace kinloop {

/// "; did you mean 'WORD'?" with the nearest of the words by Levenshtein's distance; empty where none is
/// within `max_distance`.
std::string did_you_mean(std::string_view text, std::span<const std::string> words,
                         size_t max_distance = std::numeric_limits<size_t>::max());

}  // namespace kinloop
