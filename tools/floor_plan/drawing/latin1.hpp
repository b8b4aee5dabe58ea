#pragma once
// Text for formats that know the letters of Latin-1 alone.

#include <string>

namespace kinloop {

/// Returns UTF-8 text with one byte for each letter of Latin-1, and '?' for any other.
std::string latin1_of(const std::string& utf8);

}  // namespace kinloop
