#pragma once
// Which word was meant by one that nothing has as its name.

#include <span>
#include <string>
#include <string_view>

namespace kinloop {

/// "; did you mean 'WORD'?" with the nearest of the words by edit distance (letters added, left out, replaced
/// or swapped with their neighbour), or the words of which `text` is the last part ("count" of
/// "features.count"). Empty where none is near: at most one edit for every three letters.
std::string did_you_mean(std::string_view text, std::span<const std::string> words);

}  // namespace kinloop
