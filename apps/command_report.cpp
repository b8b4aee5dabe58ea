// kinloop report: regenerates the report of a run from its folder, or compares several runs.

#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/files/report_file.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "session/store/command_files.hpp"

namespace kinloop {
namespace {

struct ReportArguments {
  std::vector<std::filesystem::path> runs;
  std::filesystem::path page;
};

void report(const ReportArguments& arguments) {
  const auto& runs = arguments.runs;
  if (runs.size() == 1 && arguments.page.empty()) {
    require_folder(runs.front());
    const auto folder = RunFolder::open_existing(runs.front());
    require_writable_file(folder.report());
    write_report(folder);
    print_text(fmt::format("{}\n", folder.report().string()));
    return;
  }
  const std::filesystem::path page = arguments.page.empty() ? "comparison.html" : arguments.page;
  CommandFiles files{.outputs = {{"-o", page}}};
  for (const auto& run : runs) add_input(files, run);
  require_outputs(files);
  write_comparison(runs, page);
  print_text(fmt::format("{}\n", page.string()), message_stream(page));
}

}  // namespace

void add_report_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("report", "Regenerate report.html, or compare several runs");
  auto arguments = std::make_shared<ReportArguments>();
  command
      ->add_option("RUN", arguments->runs,
                   "the output folder of kinloop run -o DIR; to compare several, folders or trajectories in "
                   "TUM format")
      ->required();
  command->add_option("-o,--output", arguments->page,
                      "file to write (default: DIR/report.html, or comparison.html for several runs)");
  command->footer("Example: kinloop report out out_no_loop orbslam2.txt -o comparison.html");
  command->callback([arguments] { report(*arguments); });
}

}  // namespace kinloop
