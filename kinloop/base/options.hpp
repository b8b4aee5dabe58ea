#pragma once
// Options structs with one home per field.
//
// A module's options are a plain struct with defaults in place and one static template that names every field
// once:
//
//   struct OrbOptions {
//     int count = 1000;
//     template <class Self, class Visit>
//     static void fields(Self& self, Visit&& visit) {
//       visit("count", self.count, "keypoints kept per image", Range{50, 20000});
//     }
//   };
//
// From this come `--set key=value`, the help, the checks and what run.json records. A field may itself be an
// options struct: its keys are joined with a dot ("features.count").

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

/// Allowed words of a text option.
struct Choices {
  std::vector<std::string> words;
};

using OptionValue = std::variant<bool, int64_t, double, std::string>;

/// One named field of an options struct, with its current value and a way to set it from text.
struct OptionEntry {
  std::string key;
  std::string help;      ///< meaning and unit
  std::string expected;  ///< what may be given, e.g. "a whole number from 50 to 20000"
  OptionValue value;
  std::function<void(const std::string& text)> set;  ///< throws UsageError naming key and expectation
};

namespace detail {

OptionEntry make_entry(const std::string& key, bool& field, std::string help);
OptionEntry make_entry(const std::string& key, int& field, std::string help, Range range = {});
OptionEntry make_entry(const std::string& key, double& field, std::string help, Range range = {});
OptionEntry make_entry(const std::string& key, std::string& field, std::string help, Choices choices = {});

template <class T>
concept OptionsStruct = requires(T& value) {
  T::fields(value, [](auto&&...) {});
};

template <class Options>
void collect_entries(Options& options, const std::string& prefix, std::vector<OptionEntry>& entries) {
  Options::fields(options, [&]<class Field, class... Rest>(const char* name, Field& field, Rest&&... rest) {
    if constexpr (OptionsStruct<Field>) {
      collect_entries(field, prefix + name + ".", entries);
    } else {
      entries.push_back(make_entry(prefix + name, field, std::forward<Rest>(rest)...));
    }
  });
}

}  // namespace detail

/// All fields of `options`, nested ones included, in the order of declaration. The entries refer to
/// `options`.
template <class Options>
std::vector<OptionEntry> option_entries(Options& options) {
  std::vector<OptionEntry> entries;
  detail::collect_entries(options, "", entries);
  return entries;
}

/// Applies "key=value" to `entries`. Throws UsageError for an unknown key (naming the nearest), or a bad
/// value.
void apply_assignment(std::span<const OptionEntry> entries, const std::string& assignment);

/// `options` with the assignments ("key=value") applied in order.
template <class Options>
Options with_assignments(Options options, std::span<const std::string> assignments) {
  const auto entries = option_entries(options);
  for (const auto& assignment : assignments) apply_assignment(entries, assignment);
  return options;
}

/// The value as `--set` would take it.
std::string to_text(const OptionValue& value);

/// One line per option: key, default, meaning and what is expected.
std::string options_help(std::span<const OptionEntry> entries);

}  // namespace kinloop
