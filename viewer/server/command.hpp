#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace kinloop {

enum class CommandKind { kPause, kResume, kStep, kSave, kWithdrawLoop };

/// What a browser asks for; anything else ends the connection.
struct Command {
  CommandKind kind = CommandKind::kPause;
  std::string loop = {};  ///< to be withdrawn: the stamps of its keyframes, "12.3,45.6"

  bool operator==(const Command&) const = default;
};

/// Parses a message {"command": "pause"} or {"command": "withdraw", "loop": "12.3,45.6"}; nullopt if it is
/// not a command.
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
