#pragma once
// Options structs that declare each field in one place.
//
// The options of a module are a plain struct with default values and one static template that lists every
// field once:
//
//   enum class Corners { kFast, kHarris };
//   constexpr auto option_names(Corners) {
//     return std::to_array<EnumName<Corners>>({{Corners::kFast, "fast"}, {Corners::kHarris, "harris"}});
//   }
//
//   struct OrbOptions {
//     int count = 1000;
//     Corners corners = Corners::kFast;
//     int border_px = 16;
//     template <class Self, class Visit>
//     static void fields(Self& self, Visit&& visit) {
//       visit("count", self.count, "keypoints kept per image", Range{50, 20000});
//       visit("corners", self.corners, "corner detector");
//       visit("border_px", self.border_px, "margin of the image without corners, px", Range{0, 100},
//       Expert{});
//     }
//   };
//
// This provides `--set key=value`, the help, range checks (`validate`) and the options in run.json. A field
// may itself be an options struct: its keys are joined with a dot ("features.count").

#include <array>
#include <concepts>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

namespace kinloop {

/// Closed interval of allowed numbers.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

/// Marks a field, or a nested struct, that few users need to change. It can be set like any other, but the
/// help lists it only with all options.
struct Expert {};

/// A value of an enum and its name on the command line.
template <class Enum>
struct EnumName {
  Enum value;
  std::string_view name;
};

/// An enum that can be an option: `option_names(Enum)` lists its values with their names.
template <class T>
concept NamedEnum = std::is_enum_v<T> && requires(T value) {
  option_names(value)[0].name;
};

/// Returns the name of `value`; empty if it is not a value of the enum.
template <NamedEnum Enum>
constexpr std::string_view name_of(Enum value) {
  for (const auto& entry : option_names(value)) {
    if (entry.value == value) return entry.name;
  }
  return {};
}

/// Returns the value of that name; nullopt if there is none.
template <NamedEnum Enum>
constexpr std::optional<Enum> value_named(std::string_view name) {
  for (const auto& entry : option_names(Enum{})) {
    if (entry.name == name) return entry.value;
  }
  return std::nullopt;
}

/// Returns all names of the enum in table order.
template <NamedEnum Enum>
std::vector<std::string> names_of() {
  std::vector<std::string> names;
  for (const auto& entry : option_names(Enum{})) names.emplace_back(entry.name);
  return names;
}

using OptionValue = std::variant<bool, int64_t, double, std::string>;

/// One named field of an options struct, with its current value and a setter from text.
struct OptionEntry {
  std::string key;
  std::string help;      ///< meaning and unit
  std::string expected;  ///< allowed values, e.g. "a whole number from 50 to 20000"
  OptionValue value;
  /// Throws UsageError with the key and the allowed values.
  std::function<void(const std::string& text)> set;
  bool expert = false;  ///< listed only with all options
};

/// A name of the previous version. Both names may end in ".*" if the group was renamed.
struct RenamedOption {
  std::string before;
  std::string now;
};

/// Renamed and removed options of the previous version, which `--set` and map files may still contain.
struct OptionHistory {
  std::vector<RenamedOption> renamed;
  std::vector<std::string> removed;  ///< may end in ".*"
};

/// Selects the options to list.
enum class OptionSelection { kDocumented, kAll };

namespace detail {

/// Attributes of a field besides its name.
struct FieldTraits {
  std::string help;
  Range range;
  bool expert = false;

  void add(const char* text) { help = text; }
  void add(Range allowed) { range = allowed; }
  void add(Expert) { expert = true; }
};

OptionEntry make_entry(const std::string& key, bool& field, const FieldTraits& traits);
OptionEntry make_entry(const std::string& key, int& field, const FieldTraits& traits);
OptionEntry make_entry(const std::string& key, double& field, const FieldTraits& traits);
OptionEntry make_entry(const std::string& key, std::string& field, const FieldTraits& traits);

/// Returns an entry that accepts one of `names`; `choose` receives the index of the given name.
OptionEntry make_choice_entry(const std::string& key, std::string_view current, const FieldTraits& traits,
                              std::vector<std::string> names, std::function<void(size_t index)> choose);

template <NamedEnum Enum>
OptionEntry make_entry(const std::string& key, Enum& field, const FieldTraits& traits) {
  return make_choice_entry(key, name_of(field), traits, names_of<Enum>(),
                           [&field](size_t index) { field = option_names(Enum{})[index].value; });
}

template <class T>
concept OptionsStruct = requires(T& value) {
  T::fields(value, [](auto&&...) {});
};

template <class T>
concept HasOptionHistory = requires {
  { T::history() } -> std::same_as<OptionHistory>;
};

template <class Options>
void collect_entries(Options& options, const std::string& prefix, bool expert,
                     std::vector<OptionEntry>& entries) {
  const auto visit = [&]<class Field, class... Rest>(const char* name, Field& field, const Rest&... rest) {
    FieldTraits traits;
    traits.expert = expert;
    (traits.add(rest), ...);
    if constexpr (OptionsStruct<Field>) {
      collect_entries(field, prefix + name + ".", traits.expert, entries);
    } else {
      entries.push_back(make_entry(prefix + name, field, traits));
    }
  };
  Options::fields(options, visit);
}

void validate(std::span<const OptionEntry> entries);

}  // namespace detail

/// Returns all fields of `options` in order of declaration, including nested ones. The entries refer to
/// `options`. `prefix` is prepended to every key ("dense.").
template <class Options>
std::vector<OptionEntry> option_entries(Options& options, const std::string& prefix = {}) {
  std::vector<OptionEntry> entries;
  detail::collect_entries(options, prefix, false, entries);
  return entries;
}

/// Returns the renamed and removed options: `Options::history()` if it exists, else none.
template <class Options>
OptionHistory option_history() {
  if constexpr (detail::HasOptionHistory<Options>) {
    return Options::history();
  } else {
    return {};
  }
}

/// Throws UsageError with key, value and allowed values if a value is one that `--set` rejects: out of range,
/// not finite, or not a value of its enum. `prefix` is prepended to the keys. For library entry points;
/// options from `--set` are already checked.
template <class Options>
void validate(Options options, const std::string& prefix = {}) {
  detail::validate(option_entries(options, prefix));
}

/// The current meaning of a key of this or the previous version.
struct ResolvedKey {
  enum class Kind { kCurrent, kRenamed, kRemoved, kUnknown };
  Kind kind = Kind::kUnknown;
  std::string key;  ///< current name; the given key if it was removed or is unknown
};

/// Looks `key` up in `entries`, then in `history`.
ResolvedKey resolve_key(std::span<const OptionEntry> entries, const std::string& key,
                        const OptionHistory& history);

/// Applies "key=value" to `entries`. A former name works with a warning; a removed one is ignored with a
/// warning. Throws UsageError for an unknown key (naming the nearest) or a bad value.
void apply_assignment(std::span<const OptionEntry> entries, const std::string& assignment,
                      const OptionHistory& history = {});

/// Returns `options` with the assignments ("key=value") applied in order.
template <class Options>
Options with_assignments(Options options, std::span<const std::string> assignments) {
  const auto entries = option_entries(options);
  const auto history = option_history<Options>();
  for (const auto& assignment : assignments) apply_assignment(entries, assignment, history);
  return options;
}

/// Returns the value in the format of `--set`.
std::string to_text(const OptionValue& value);

/// Returns key, default, meaning and allowed values of each option; those marked Expert only if requested.
std::string options_help(std::span<const OptionEntry> entries,
                         OptionSelection selection = OptionSelection::kDocumented);

}  // namespace kinloop
