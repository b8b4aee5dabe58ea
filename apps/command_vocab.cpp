// kinloop vocab: trains, inspects and converts vocabularies for the place index.

#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "apps/shared/command_line/commands.hpp"
#include "apps/vocab/vocab_train.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/place/vocabulary/default_vocabulary.hpp"
#include "kinloop/place/vocabulary/vocabulary_file.hpp"
#include "session/store/command_files.hpp"
#include "tools/vocabulary_training/dbow2_text.hpp"

namespace kinloop {
namespace {

constexpr const char* kDefaultName = "default";  ///< the built-in vocabulary

Vocabulary open_named(const std::string& name) {
  return name == kDefaultName ? load_default_vocabulary() : read_vocabulary(name);
}

void info(const std::string& name) {
  const Stopwatch watch;
  const Vocabulary vocabulary = open_named(name);
  const double opening_s = watch.wall_s();
  print_stats(vocabulary);
  fmt::print("opened in      {:.2f} ms\n", 1000 * opening_s);
}

/// Adds a command that converts one file to another.
void add_conversion(CLI::App& vocab, const char* name, const char* help, const char* input_help,
                    void (*convert)(const std::string& input, const std::filesystem::path& output)) {
  struct Arguments {
    std::string input;
    std::filesystem::path output;
  };
  CLI::App* command = vocab.add_subcommand(name, help);
  auto arguments = std::make_shared<Arguments>();
  command->add_option("file", arguments->input, input_help)->required();
  command->add_option("-o,--output", arguments->output, "the file to write")->required();
  command->callback([arguments, convert] {
    require_outputs({.inputs = {arguments->input}, .outputs = {{"-o", arguments->output}}});
    convert(arguments->input, arguments->output);
  });
}

void add_info_command(CLI::App& vocab) {
  CLI::App* command = vocab.add_subcommand("info", "Show statistics of a vocabulary");
  auto name = std::make_shared<std::string>(kDefaultName);
  command->add_option("file", *name, "a vocabulary file, or 'default' for the built-in one")
      ->capture_default_str();
  command->callback([name] { info(*name); });
}

}  // namespace

void add_vocab_command(CLI::App& app) {
  CLI::App* vocab = app.add_subcommand("vocab", "Train, inspect and convert visual vocabularies");
  vocab->require_subcommand(1);
  add_train_command(*vocab);
  add_describe_command(*vocab);
  add_info_command(*vocab);
  add_conversion(*vocab, "import", "Import a vocabulary in the text format of DBoW2 and ORB-SLAM",
                 "the text file (unpacked)",
                 [](const std::string& input, const std::filesystem::path& output) {
                   const Vocabulary vocabulary = read_dbow2(input);
                   write_vocabulary(output, vocabulary);
                   print_stats(vocabulary);
                 });
  add_conversion(*vocab, "export", "Export a vocabulary in the text format of DBoW2 and ORB-SLAM",
                 "a vocabulary file, or 'default' for the built-in one",
                 [](const std::string& input, const std::filesystem::path& output) {
                   write_dbow2(output, open_named(input));
                 });
}

}  // namespace kinloop
