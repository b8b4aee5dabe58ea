#include "viewer/server/command.hpp"

#include <algorithm>
#include <string>

#include <nlohmann/json.hpp>

namespace kinloop {

std::optional<Command> parse_command(std::string_view message) {
  const auto json = nlohmann::json::parse(message, nullptr, false);
  const auto text = [&](const char* key) {
    const bool known = json.is_object() && json.contains(key) && json[key].is_string();
    return known ? json[key].get<std::string>() : std::string();
  };
  const std::string name = text("command"), loop = text("loop");
  if (name == "pause") return Command{CommandKind::kPause};
  if (name == "resume") return Command{CommandKind::kResume};
  if (name == "step") return Command{CommandKind::kStep};
  if (name == "save") return Command{CommandKind::kSave};
  if (name == "withdraw" && !loop.empty()) return Command{CommandKind::kWithdrawLoop, loop};
  return std::nullopt;
}

bool CommandRate::allows(std::chrono::steady_clock::time_point now) {
  constexpr double kAtOnce = 100, kPerSecond = 20;
  const std::chrono::duration<double> since = now - filled_;
  left_ = std::min(kAtOnce, left_ + kPerSecond * since.count());
  filled_ = now;
  if (left_ < 1) return false;
  left_ -= 1;
  return true;
}

}  // namespace kinloop
