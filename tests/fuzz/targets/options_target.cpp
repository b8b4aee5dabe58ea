#include <algorithm>
#include <vector>

#include "session/plan/run_options.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace kinloop::fuzz {

/// Each line is an assignment, as after --set.
void read_option_bytes(std::string_view bytes) {
  // The entries refer to the options; making them takes far longer than reading an assignment.
  static RunOptions options;
  static const std::vector<OptionEntry> entries = option_entries(options);
  options = {};
  accept<UsageError>([&] {
    while (!bytes.empty()) {
      const std::string line(bytes.substr(0, bytes.find('\n')));
      bytes.remove_prefix(std::min(bytes.size(), line.size() + 1));
      apply_assignment(entries, line);
    }
    validate(options.slam);
    const auto written = option_entries(options);
    for (const OptionEntry& entry : written) entry.set(to_text(entry.value));
    const auto read = option_entries(options);
    for (size_t i = 0; i < read.size(); ++i)
      require(to_text(read[i].value) == to_text(written[i].value), "an option is not read as it is written");
  });
}

}  // namespace kinloop::fuzz
