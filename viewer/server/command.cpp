#include "viewer/server/command.hpp"

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

}  // namespace kinloop
