#pragma once
// Options structs with one home per field.
//
// A module's options are a plain struct with defaults in place and one static template that names every field
// once:
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
// From this come `--set key=value`, the help, the checks (`validate`) and what run.json records. A field may
// itself be an options struct: its keys are joined with a dot ("features.count").

#include <array>
#include <concepts>
#include <cstdint>
#include <functional>
#include <limits>
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

/// Marks a field, or a whole nested struct, that few users have a reason to change: it can be set like any
/// other, but the help leaves it out unless asked for all.
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

/// The name of `value`; empty for a number that is no value of the enum.
template <NamedEnum Enum>
constexpr std::string_view name_of(Enum value) {
  for (const auto& entry : option_names(value)) {
    if (entry.value == value) return entry.name;
  }
  return {};
}

/// All names of the enum, in the order of its table.
template <NamedEnum Enum>
std::vector<std::string> names_of() {
  std::vector<std::string> names;
  for (const auto& entry : option_names(Enum{})) names.emplace_back(entry.name);
  return names;
}

using OptionValue = std::variant<bool, int64_t, double, std::string>;

/// One named field of an options struct, with its current value and a way to set it from text.
struct OptionEntry {
  std::string key;
  std::string help;      ///< meaning and unit
  std::string expected;  ///< what may be given, e.g. "a whole number from 50 to 20000"
  OptionValue value;
  std::function<void(const std::string& text)> set;  ///< throws UsageError naming key and expectation
  bool expert = false;                               ///< listed only when all options are asked for
};

/// A name of the version before. Both names may end in ".*": the group was renamed.
struct RenamedOption {
  std::string before;
  std::string now;
};

/// What became of the options of the version before: `--set` and map files may still name them.
struct OptionHistory {
  std::vector<RenamedOption> renamed;
  std::vector<std::string> removed;  ///< may end in ".*"
};

/// Which options a list shows.
enum class OptionSelection { kDocumented, kAll };

namespace detail {

/// What `fields` says of a field, beside its name.
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

/// An entry that takes one of `names`; `choose` gets the index of the one that was given.
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

/// All fields of `options`, nested ones included, in the order of declaration. The entries refer to
/// `options`. `prefix` stands before every key ("dense.").
template <class Options>
std::vector<OptionEntry> option_entries(Options& options, const std::string& prefix = {}) {
  std::vector<OptionEntry> entries;
  detail::collect_entries(options, prefix, false, entries);
  return entries;
}

/// What became of former names: that of `Options::history()`, where it has one.
template <class Options>
OptionHistory option_history() {
  if constexpr (detail::HasOptionHistory<Options>) {
    return Options::history();
  } else {
    return {};
  }
}

/// Throws UsageError, naming key, value and expectation, where a value is one that `--set` would not take:
/// out of range, not finite, no value of its enum. `prefix` stands before the keys. For the entry points of
/// the library; options that come from `--set` are checked already.
template <class Options>
void validate(Options options, const std::string& prefix = {}) {
  detail::validate(option_entries(options, prefix));
}

/// What a key of this version or the one before means now.
struct ResolvedKey {
  enum class Kind { kCurrent, kRenamed, kRemoved, kUnknown };
  Kind kind = Kind::kUnknown;
  std::string key;  ///< of this version; as given where it is removed or unknown
};

/// Looks `key` up in `entries`, then in `history`.
ResolvedKey resolve_key(std::span<const OptionEntry> entries, const std::string& key,
                        const OptionHistory& history);

/// Applies "key=value" to `entries`. A former name works with a warning; one that no longer exists is ignored
/// with a warning. Throws UsageError for an unknown key (naming the nearest), or a bad value.
void apply_assignment(std::span<const OptionEntry> entries, const std::string& assignment,
                      const OptionHistory& history = {});

/// `options` with the assignments ("key=value") applied in order.
template <class Options>
Options with_assignments(Options options, std::span<const std::string> assignments) {
  const auto entries = option_entries(options);
  const auto history = option_history<Options>();
  for (const auto& assignment : assignments) apply_assignment(entries, assignment, history);
  return options;
}

/// The value as `--set` would take it.
std::string to_text(const OptionValue& value);

/// For each option key, default, meaning and what is expected; those marked Expert only when all are asked
/// for.
std::string options_help(std::span<const OptionEntry> entries,
                         OptionSelection selection = OptionSelection::kDocumented);

}  // namespace kinloop
