#pragma once
// Small letters, for names that are compared without regard to case.

#include <cctype>
#include <string>

namespace kinloop {

/// Returns the text with small letters in place of the capitals of ASCII.
inline std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace kinloop
