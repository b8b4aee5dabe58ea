#include "apps/shared/command_line/command_line.hpp"

#include <algorithm>
#include <filesystem>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/text/did_you_mean.hpp"

namespace kinloop {
namespace {

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<std::string> names_of(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands) names.push_back(command->get_name());
  return names;
}

/// The options as written, "--output" and "-o".
std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
    for (const auto& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

[[noreturn]] void reject_command(const CLI::App& app, const std::string& word,
                                 const std::vector<std::string>& names) {
  std::error_code ignored;
  std::string remedy = did_you_mean(word, names);
  if (remedy.empty() && app.get_parent() == nullptr && std::filesystem::exists(word, ignored)) {
    remedy = fmt::format("; to map it: kinloop run {}", word);
  }
  throw UsageError(fmt::format("{0}: unknown command '{1}'{2}{3} {0} --help", app.get_name(), word, remedy,
                               remedy.ends_with('?') ? " See" : "; see"));
}

/// The words that no option or argument of the command consumed; "--" alone does not count.
std::vector<std::string> leftovers(const CLI::App& program) {
  auto left = program.remaining(true);
  std::erase(left, "--");
  return left;
}

std::string unknown_option(const std::string& left, const CLI::App& command,
                           std::span<const std::string> words) {
  std::string name = left.substr(0, left.find('='));
  // Of "-verbose" CLI11 consumes "-v" and leaves "-erbose".
  const auto as_written = std::find_if(words.begin(), words.end(), [&](const std::string& word) {
    return !name.starts_with("--") && word.starts_with('-') && word.ends_with(name.substr(1));
  });
  if (as_written != words.end()) name = *as_written;
  return fmt::format("unknown option {}{}", name, did_you_mean(name, option_names(command)));
}

/// Rewrites CLI11's messages in the program's style.
std::string rewrite_cli11_message(std::string text) {
  constexpr std::string_view kConversion = "Could not convert: ";
  if (text.starts_with(kConversion)) {
    text.erase(0, kConversion.size());
    const size_t equals = text.find(" = ");
    if (equals == std::string::npos) return text + " is invalid";
    return fmt::format("{}: '{}' is not a number or is out of range", text.substr(0, equals),
                       text.substr(equals + 3));
  }
  if (text.ends_with(" missing")) return text.substr(0, text.find(':')) + " requires a value";
  if (text.ends_with(" is required")) return text.substr(0, text.rfind(" is ")) + " is missing";
  const size_t excludes = text.find(" excludes ");
  if (excludes != std::string::npos) text.replace(excludes, 10, " cannot be combined with ");
  return text;
}

std::string what_is_wrong(const CLI::ParseError& error, const CLI::App& program, const CLI::App& command,
                          std::span<const std::string> words) {
  const auto left = leftovers(program);
  const auto option =
      std::find_if(left.begin(), left.end(), [](const auto& word) { return word.starts_with('-'); });
  if (option != left.end()) return unknown_option(*option, command, words);
  if (!left.empty()) return fmt::format("unexpected argument '{}'", fmt::join(left, " "));
  const auto commands = commands_of(command);
  if (!commands.empty())
    return fmt::format("expected one of the commands {}", fmt::join(names_of(commands), ", "));
  return rewrite_cli11_message(error.what());
}

}  // namespace

std::string full_name(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name() : full_name(*app.get_parent()) + " " + app.get_name();
}

const CLI::App& find_command(const CLI::App& program, std::span<const std::string> words) {
  const CLI::App* app = &program;
  for (const std::string& word : words) {
    const auto commands = commands_of(*app);
    if (commands.empty() || word.starts_with('-')) break;
    const auto names = names_of(commands);
    const auto named = std::find(names.begin(), names.end(), word);
    if (named == names.end()) reject_command(*app, word, names);
    app = commands[static_cast<size_t>(named - names.begin())];
  }
  return *app;
}

std::string explain_parse_error(const CLI::ParseError& error, const CLI::App& program,
                                std::span<const std::string> words) {
  const CLI::App& command = find_command(program, words);
  const std::string name = full_name(command), wrong = what_is_wrong(error, program, command, words);
  return fmt::format("{}: {}{} {} --help", name, wrong, wrong.ends_with('?') ? " See" : "; see", name);
}

}  // namespace kinloop
