// kinloop report: makes the report of a run anew from the files in its folder.

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "apps/commands.hpp"
#include "apps/report_file.hpp"
#include "kinloop/base/text_file.hpp"

namespace kinloop {

void add_report_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("report", "Make report.html anew from the files of a run");
  auto path = std::make_shared<std::filesystem::path>();
  command->add_option("DIR", *path, "The folder that kinloop run -o DIR wrote")->required();
  command->callback([path] {
    require_folder(*path);
    const RunFolder folder(*path);
    write_report(folder);
    fmt::print("{}\n", folder.report().string());
  });
}

}  // namespace kinloop
