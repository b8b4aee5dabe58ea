#include "kinloop/core/options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/text/did_you_mean.hpp"

namespace kinloop {
namespace {

[[noreturn]] void reject(const std::string& key, const std::string& text, const std::string& expected) {
  throw UsageError(fmt::format("option {}: '{}' is not {}", key, text, expected));
}

template <class Number>
Number parse_number(const std::string& key, const std::string& text, const std::string& expected,
                    Range range) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole_text = error == std::errc() && end == text.data() + text.size();
  const auto as_double = static_cast<double>(value);
  if (!whole_text || !std::isfinite(as_double) || as_double < range.low || as_double > range.high) {
    reject(key, text, expected);
  }
  return value;
}

std::string describe(const char* kind, Range range) {
  if (std::isinf(range.low) && std::isinf(range.high)) return kind;
  if (std::isinf(range.high)) return fmt::format("{} of at least {}", kind, range.low);
  return fmt::format("{} from {} to {}", kind, range.low, range.high);
}

}  // namespace

namespace detail {

OptionEntry make_entry(const std::string& key, bool& field, const FieldTraits& traits) {
  const auto set = [key, &field](const std::string& text) {
    if (text == "true" || text == "on" || text == "1") {
      field = true;
    } else if (text == "false" || text == "off" || text == "0") {
      field = false;
    } else {
      reject(key, text, "true or false");
    }
  };
  return {key, traits.help, "true or false", field, set, traits.expert};
}

OptionEntry make_entry(const std::string& key, int& field, const FieldTraits& traits) {
  const std::string expected = describe("a whole number", traits.range);
  const auto set = [key, &field, expected, range = traits.range](const std::string& text) {
    field = parse_number<int>(key, text, expected, range);
  };
  return {key, traits.help, expected, static_cast<int64_t>(field), set, traits.expert};
}

OptionEntry make_entry(const std::string& key, double& field, const FieldTraits& traits) {
  const std::string expected = describe("a number", traits.range);
  const auto set = [key, &field, expected, range = traits.range](const std::string& text) {
    field = parse_number<double>(key, text, expected, range);
  };
  return {key, traits.help, expected, field, set, traits.expert};
}

OptionEntry make_entry(const std::string& key, std::string& field, const FieldTraits& traits) {
  const auto set = [&field](const std::string& text) { field = text; };
  return {key, traits.help, "text", field, set, traits.expert};
}

OptionEntry make_choice_entry(const std::string& key, std::string_view current, const FieldTraits& traits,
                              std::vector<std::string> names, std::function<void(size_t)> choose) {
  const std::string expected = fmt::format("one of {}", fmt::join(names, ", "));
  const auto set = [key, expected, names = std::move(names),
                    choose = std::move(choose)](const std::string& text) {
    const auto found = std::find(names.begin(), names.end(), text);
    if (found == names.end()) reject(key, text, expected);
    choose(static_cast<size_t>(found - names.begin()));
  };
  return {key, traits.help, expected, std::string(current), set, traits.expert};
}

void validate(std::span<const OptionEntry> entries) {
  for (const OptionEntry& entry : entries) entry.set(to_text(entry.value));
}

}  // namespace detail

namespace {

bool has_key(std::span<const OptionEntry> entries, const std::string& key) {
  return std::any_of(entries.begin(), entries.end(), [&](const auto& entry) { return entry.key == key; });
}

/// Whether `pattern`, a key or a group "name.*", matches `key`.
bool covers(const std::string& pattern, const std::string& key) {
  if (!pattern.ends_with(".*")) return pattern == key;
  return key.starts_with(std::string_view(pattern).substr(0, pattern.size() - 1));
}

/// Returns the new name of `key`, which `renamed.before` matches.
std::string later_name(const RenamedOption& renamed, const std::string& key) {
  if (!renamed.before.ends_with(".*")) return renamed.now;
  return renamed.now.substr(0, renamed.now.size() - 1) + key.substr(renamed.before.size() - 1);
}

[[noreturn]] void reject_key(std::span<const OptionEntry> entries, const std::string& key) {
  std::vector<std::string> keys;
  for (const OptionEntry& entry : entries) keys.push_back(entry.key);
  throw UsageError(fmt::format("unknown option '{}'{}", key, did_you_mean(key, keys)));
}

}  // namespace

ResolvedKey resolve_key(std::span<const OptionEntry> entries, const std::string& key,
                        const OptionHistory& history) {
  using Kind = ResolvedKey::Kind;
  std::string name = key;
  // Both a group and one of its keys may have been renamed: each iteration applies one renaming.
  for (size_t turn = 0; turn <= history.renamed.size(); ++turn) {
    if (has_key(entries, name)) return {name == key ? Kind::kCurrent : Kind::kRenamed, name};
    const auto& removed = history.removed;
    if (std::any_of(removed.begin(), removed.end(), [&](const auto& gone) { return covers(gone, name); }))
      return {Kind::kRemoved, key};
    const auto renamed = std::find_if(history.renamed.begin(), history.renamed.end(),
                                      [&](const RenamedOption& r) { return covers(r.before, name); });
    if (renamed == history.renamed.end()) break;
    name = later_name(*renamed, name);
  }
  return {Kind::kUnknown, key};
}

void apply_assignment(std::span<const OptionEntry> entries, const std::string& assignment,
                      const OptionHistory& history) {
  using Kind = ResolvedKey::Kind;
  const size_t equals = assignment.find('=');
  if (equals == std::string::npos) {
    const std::string example =
        entries.empty() ? "" : fmt::format(", e.g. {}={}", entries[0].key, to_text(entries[0].value));
    throw UsageError(fmt::format("option '{}': expected key=value{}", assignment, example));
  }
  const std::string given = assignment.substr(0, equals);
  const auto [kind, key] = resolve_key(entries, given, history);
  if (kind == Kind::kUnknown) reject_key(entries, given);
  if (kind == Kind::kRemoved) return log::warn("option {} no longer exists and is ignored", given);
  if (kind == Kind::kRenamed) log::warn("option {} is now called {}", given, key);
  const auto entry =
      std::find_if(entries.begin(), entries.end(), [&, &key = key](const auto& e) { return e.key == key; });
  entry->set(assignment.substr(equals + 1));
}

std::string to_text(const OptionValue& value) {
  return std::visit([](const auto& v) { return fmt::format("{}", v); }, value);
}

std::string options_help(std::span<const OptionEntry> entries, OptionSelection selection) {
  std::string help;
  for (const auto& entry : entries) {
    if (entry.expert && selection == OptionSelection::kDocumented) continue;
    help +=
        fmt::format("  {}={}\n      {} ({})\n", entry.key, to_text(entry.value), entry.help, entry.expected);
  }
  return help;
}

}  // namespace kinloop
