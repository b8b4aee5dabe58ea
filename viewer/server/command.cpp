#include "viewer/server/command.hpp"

#include <algorithm>
#include <string>

#include <nlohmann/json.hpp>

namespace kinloop {

std::optional<Command> parse_command(std::string_view message) {
  const auto json = nlohmann::json::parse(message, nullptr, false);
  if (!json.is_object() || !json.contains("command") || !json["command"].is_string()) return std::nullopt;
  const std::string name = json["command"];
  if (name == "pause") return Command::kPause;
  if (name == "resume") return Command::kResume;
  if (name == "step") return Command::kStep;
  if (name == "save") return Command::kSave;
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
