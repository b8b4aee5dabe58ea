#pragma once

#include <chrono>
#include <optional>
#include <string_view>

namespace kinloop {

/// Commands of browsers; anything else ends the connection.
enum class Command { kPause, kResume, kStep, kSave };

/// Parses a message {"command": "pause"}; nullopt if it is not a command.
std::optional<Command> parse_command(std::string_view message);

/// Limits the commands of one browser: 100 at once, 20 a second on average (a held key repeats 30 times a
/// second).
class CommandRate {
 public:
  /// Counts a command at a time; returns false if there were too many.
  bool allows(std::chrono::steady_clock::time_point now);

 private:
  std::chrono::steady_clock::time_point filled_ = {};
  double left_ = 0;
};

}  // namespace kinloop
