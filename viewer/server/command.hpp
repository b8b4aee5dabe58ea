#pragma once

#include <optional>
#include <string_view>

namespace kinloop {

/// Commands of browsers; anything else ends the connection.
enum class Command { kPause, kResume, kStep, kSave };

/// Parses a message {"command": "pause"}; nullopt if it is not a command.
std::optional<Command> parse_command(std::string_view message);

}  // namespace kinloop
