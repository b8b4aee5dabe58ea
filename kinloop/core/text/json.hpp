#pragma once
// JSON as text. Output passes through here, as text that is not UTF-8 (a path may hold any bytes) must not
// end a run. Input is parsed here, or by readers that name the byte of an error, which check its depth here:
// what is deeply nested must not exhaust the stack.

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace kinloop {

/// Values in values; nlohmann's writer, and code that walks a value, recurse that deep.
constexpr size_t kMaxJsonDepth = 200;

/// Which characters json_text writes as they are.
enum class JsonCharacters { kUtf8, kAscii };

/// Returns the value as text; bytes that are not UTF-8 become U+FFFD. `indent` -1: on one line.
std::string json_text(const nlohmann::json& value, int indent = -1,
                      JsonCharacters characters = JsonCharacters::kUtf8);

/// Same, in the order in which the members were added.
std::string ordered_json_text(const nlohmann::ordered_json& value, int indent = -1);

/// Returns whether the text has more than kMaxJsonDepth brackets open at once.
bool is_nested_too_deeply(std::string_view text);

/// Returns the value; a discarded one (is_discarded()) if the text is not JSON or is nested too deeply.
nlohmann::json parse_json(std::string_view text);

}  // namespace kinloop
