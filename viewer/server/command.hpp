#pragma once

#include <optional>
#include <string_view>

namespace kinloop {

/// What a browser may ask for; anything else ends its connection.
enum class Command { kPause, kResume, kStep, kSave };

/// The command in a message {"command": "pause"}; nothing where it is not one.
std::optional<Command> parse_command(std::string_view message);

}  // namespace kinloop
