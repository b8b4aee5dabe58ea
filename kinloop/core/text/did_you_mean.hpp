#pragma once
// Suggestions for misspelt words.

#include <span>
#include <string>
#include <string_view>

namespace kinloop {

/// Returns "; did you mean 'WORD'?" with the nearest words by edit distance (insertion, deletion,
/// substitution or transposition), or with the words whose last component is `text` ("count" for
/// "features.count"). Empty if no word is near: at most one edit per three letters.
std::string did_you_mean(std::string_view text, std::span<const std::string> words);

}  // namespace kinloop
