#include <algorithm>

#include "apps/run/run_options.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace kinloop::fuzz {

/// Each line is an assignment, as after --set.
void read_option_bytes(std::string_view bytes) {
  std::vector<std::string> assignments;
  while (!bytes.empty()) {
    assignments.emplace_back(bytes.substr(0, bytes.find('\n')));
    bytes.remove_prefix(std::min(bytes.size(), assignments.back().size() + 1));
  }
  accept<UsageError>([&] {
    RunOptions options = run_options_with({}, assignments);
    validate(options);
    static_cast<void>(resolve_options(options.slam));
    const auto entries = option_entries(options);
    for (const OptionEntry& entry : entries) {
      const auto is_of_entry = [&](const std::string& text) { return text.starts_with(entry.key + "="); };
      if (std::none_of(assignments.begin(), assignments.end(), is_of_entry)) continue;
      const std::string value = to_text(entry.value);
      apply_assignment(entries, entry.key + "=" + value);
      require(to_text(entry.value) == value, "an option is not read as it is written");
    }
  });
}

}  // namespace kinloop::fuzz
