// kinloop fetch: downloads and unpacks a sequence of a public dataset.

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/fetch/public_datasets.hpp"
#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "apps/shared/files/download.hpp"
#include "apps/shared/terminal/progress_bar.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "drivers/archives/unpack_archive.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/output_file.hpp"
#include "kinloop/core/files/writable_check.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

struct FetchArguments {
  std::string name;
  fs::path output = ".";
  std::string server;  ///< "" for that of the dataset
  bool list = false;
  bool quiet = false;
};

void list_datasets() {
  std::string text;
  for (const PublicDataset& dataset : public_datasets()) {
    if (dataset.examples.empty()) continue;
    text += fmt::format("{}\n  {}\n  licence: {}\n", dataset.title, dataset.examples, dataset.licence);
    if (!dataset.access.empty()) text += fmt::format("  access: {}\n", dataset.access);
  }
  print_text(text);
}

/// The archive of the sequence alone in the folder; "" if there is none.
fs::path archive_of_sequence(const fs::path& folder, const FetchPlan& plan) {
  if (plan.sequence.empty()) return {};
  for (const char* extension : {".zip", ".7z"}) {
    if (fs::path archive = folder / (plan.sequence + extension); fs::exists(archive)) return archive;
  }
  return {};
}

/// Whether the sequence is in the folder, unpacked or as an archive of its own.
bool holds_sequence(const fs::path& folder, const FetchPlan& plan) {
  return fs::exists(folder / plan.sequence / plan.evidence) || !archive_of_sequence(folder, plan).empty();
}

/// The address to download from, without a slash at the end. Throws UsageError if only the user can know it.
std::string server_of(const FetchPlan& plan, const FetchArguments& arguments) {
  std::string server = arguments.server.empty() ? plan.server : arguments.server;
  if (server.empty()) {
    const char* given = std::getenv(plan.server_variable.c_str());  // NOLINT(concurrency-mt-unsafe)
    if (given != nullptr) server = given;
  }
  if (server.empty()) {
    throw UsageError(fmt::format(
        "fetch: {} is given only to those who ask for it: {}; give it as --server or as the variable {}",
        arguments.name, plan.access, plan.server_variable));
  }
  return server.substr(0, server.find_last_not_of('/') + 1);
}

/// Downloads those archives that are not there yet.
std::vector<fs::path> download_archives(const FetchPlan& plan, const FetchArguments& arguments) {
  std::vector<fs::path> archives;
  const std::string server = server_of(plan, arguments);
  for (const std::string& address : plan.archives) {
    archives.push_back(arguments.output / fs::path(address).filename());
    if (fs::exists(archives.back())) continue;
    download(fmt::format("{}/{}", server, address), archives.back(), make_progress_bar(arguments.quiet));
  }
  return archives;
}

fs::path unpack_beside(const std::vector<fs::path>& archives, const fs::path& target) {
  // Scenes of OpenLORIS, the largest known, have some 30 GB.
  constexpr uint64_t kMaxBytes = uint64_t{64} << 30;
  fs::path beside = target.string() + ".part";
  for (const fs::path& archive : archives) {
    if (archive.extension() == ".sens") {  // the recording itself
      fs::create_directories(beside);
      fs::rename(archive, beside / archive.filename());
    } else {
      unpack_archive(archive, beside, {kMaxBytes, "unpacks to more than any sequence has; not unpacked"});
    }
  }
  return beside;
}

/// Moves what was unpacked to `target`, and removes the archives once it is whole on the disk.
void put_in_place(const fs::path& beside, const std::string& inside, const fs::path& target,
                  const std::vector<fs::path>& archives) {
  flush_files(beside);
  fs::rename(inside.empty() ? beside : beside / inside, target);
  flush_files(target.parent_path());
  std::error_code ignored;
  fs::remove_all(beside, ignored);
  for (const fs::path& archive : archives) fs::remove(archive, ignored);
}

void fetch_folder(const FetchPlan& plan, const FetchArguments& arguments, const fs::path& folder) {
  if (fs::exists(folder)) {
    throw InputError(fmt::format("{}: exists, but contains no {}; move it away, or choose another folder",
                                 folder.string(), (plan.sequence / fs::path(plan.evidence)).string()));
  }
  const auto archives = download_archives(plan, arguments);
  const fs::path beside = unpack_beside(archives, folder);
  if (!holds_sequence(beside / plan.inside, plan)) {
    throw InputError(
        fmt::format("{}: not a sequence: contains no {}", archives.back().string(),
                    (fs::path(plan.inside) / plan.sequence / plan.evidence).lexically_normal().string()));
  }
  put_in_place(beside, plan.inside, folder, archives);
}

/// Unpacks the archive of the sequence alone.
void unpack_sequence(const FetchPlan& plan, const fs::path& folder) {
  const fs::path archive = archive_of_sequence(folder, plan);
  const fs::path target = folder / plan.sequence;
  const fs::path beside = unpack_beside({archive}, target);
  if (!fs::exists(beside / plan.sequence / plan.evidence)) {
    throw InputError(
        fmt::format("{}: not a sequence: contains no {}/{}", archive.string(), plan.sequence, plan.evidence));
  }
  put_in_place(beside, plan.sequence, target, {archive});
}

void fetch(const FetchArguments& arguments) {
  if (arguments.list) return list_datasets();
  if (arguments.name.empty()) throw UsageError("fetch: NAME is missing; kinloop fetch --list shows which");
  const FetchPlan plan = plan_fetch(arguments.name);
  const fs::path folder = arguments.output / plan.folder;
  const fs::path sequence = plan.sequence.empty() ? folder : folder / plan.sequence;
  if (fs::exists(sequence / plan.evidence)) {
    print_text(fmt::format("{}\nalready exists\n", sequence.string()));
    return;
  }
  require_writable_folder(arguments.output);
  if (!holds_sequence(folder, plan)) fetch_folder(plan, arguments, folder);
  if (!fs::exists(sequence / plan.evidence)) unpack_sequence(plan, folder);
  print_text(fmt::format("{}\nlicence: {}\n", sequence.string(), plan.licence));
}

}  // namespace

void add_fetch_command(CLI::App& app) {
  auto arguments = std::make_shared<FetchArguments>();
  CLI::App* command = app.add_subcommand("fetch", "Download a sequence of a public dataset");
  command->add_option("NAME", arguments->name, "e.g. tum/fr1_room, eth3d/cables_1, replica/room0");
  command->add_flag("--list", arguments->list, "list the datasets, their names and licences");
  command->add_option("-o,--output", arguments->output, "folder to download to")->capture_default_str();
  command->add_option("--server", arguments->server, "mirror to download from (default: the dataset's own)");
  add_quiet_option(*command, arguments->quiet);
  command->footer("An interrupted download resumes where it stopped.");
  command->callback([arguments] { fetch(*arguments); });
}

}  // namespace kinloop
