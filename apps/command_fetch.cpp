// kinloop fetch: downloads and unpacks a sequence of a public dataset.

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "apps/shared/commands.hpp"
#include "apps/shared/common_options.hpp"
#include "apps/shared/download.hpp"
#include "apps/shared/progress_bar.hpp"
#include "apps/shared/standard_output.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/output_file.hpp"
#include "kinloop/core/files/writable_check.hpp"

namespace kinloop {
namespace {

constexpr const char* kServer = "https://cvg.cit.tum.de/rgbd/dataset";
constexpr const char* kLicence =
    "TUM RGB-D benchmark, Creative Commons Attribution 4.0 (CC BY 4.0); cite Sturm et al., A Benchmark for "
    "the "
    "Evaluation of RGB-D SLAM Systems, IROS 2012";

struct FetchArguments {
  std::string name;
  std::filesystem::path output = ".";
  std::string server = kServer;
  bool quiet = false;
};

/// A sequence of the TUM benchmark: "tum/fr1_room" is freiburg1/rgbd_dataset_freiburg1_room.
struct TumSequence {
  std::string camera;  ///< freiburg1, 2 or 3
  std::string folder;
};

TumSequence parse_name(const std::string& name) {
  constexpr std::string_view kPrefix = "tum/fr";
  const bool right =
      name.starts_with(kPrefix) && name.size() > kPrefix.size() + 2 && name[kPrefix.size()] >= '1' &&
      name[kPrefix.size()] <= '3' && name[kPrefix.size() + 1] == '_' &&
      name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_", kPrefix.size()) == std::string::npos;
  if (!right) {
    throw UsageError(
        fmt::format("fetch: '{}' is not a known sequence; expected e.g. tum/fr1_room, tum/fr2_desk, "
                    "tum/fr3_long_office_household (their names: {})",
                    name, kServer));
  }
  const std::string camera = fmt::format("freiburg{}", name[kPrefix.size()]);
  return {camera, fmt::format("rgbd_dataset_{}{}", camera, name.substr(kPrefix.size() + 1))};
}

void fetch(const FetchArguments& arguments) {
  const TumSequence sequence = parse_name(arguments.name);
  const auto folder = arguments.output / sequence.folder;
  if (std::filesystem::exists(folder / "rgb.txt")) {
    print_text(fmt::format("{} already exists\n", folder.string()));
    return;
  }
  require_writable_folder(arguments.output);
  const auto archive = arguments.output / (sequence.folder + ".tgz");
  if (!std::filesystem::exists(archive)) {
    download(fmt::format("{}/{}/{}.tgz", arguments.server, sequence.camera, sequence.folder), archive,
             make_progress_bar(arguments.quiet));
  }
  const auto beside = arguments.output / (sequence.folder + ".part");
  unpack(archive, beside);
  if (!std::filesystem::exists(beside / sequence.folder / "rgb.txt")) {
    throw InputError(
        fmt::format("{}: not a sequence: contains no {}/rgb.txt", archive.string(), sequence.folder));
  }
  flush_files(beside);
  std::filesystem::rename(beside / sequence.folder, folder);
  flush_files(arguments.output);  // before the archive is removed
  std::error_code ignored;
  std::filesystem::remove_all(beside, ignored);
  std::filesystem::remove(archive, ignored);
  print_text(fmt::format("{}\nlicence: {}\n", folder.string(), kLicence));
}

}  // namespace

void add_fetch_command(CLI::App& app) {
  auto arguments = std::make_shared<FetchArguments>();
  CLI::App* command = app.add_subcommand("fetch", "Download a sequence of the TUM RGB-D benchmark");
  command->add_option("NAME", arguments->name, "e.g. tum/fr1_room")->required();
  command->add_option("-o,--output", arguments->output, "folder to download to")->capture_default_str();
  command->add_option("--server", arguments->server, "mirror to download from")->capture_default_str();
  add_quiet_option(*command, arguments->quiet);
  command->footer("An interrupted download resumes where it stopped.");
  command->callback([arguments] { fetch(*arguments); });
}

}  // namespace kinloop
