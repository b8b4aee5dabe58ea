// kinloop vocab: trains dictionaries for the place index, and tells what is in one.

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/commands.hpp"
#include "kinloop/base/errors.hpp"
#include "kinloop/base/log.hpp"
#include "kinloop/base/options.hpp"
#include "kinloop/base/parallel_for.hpp"
#include "kinloop/base/stopwatch.hpp"
#include "kinloop/place/default_vocabulary.hpp"
#include "kinloop/place/trainer.hpp"
#include "kinloop/place/training_images.hpp"
#include "kinloop/place/vocabulary_file.hpp"
#include "kinloop/place/vocabulary_stats.hpp"

namespace kinloop {
namespace {

constexpr const char* kDefaultName = "default";  ///< the dictionary built into the program

struct TrainArguments {
  std::vector<std::filesystem::path> images;
  std::vector<std::filesystem::path> held_out;
  std::filesystem::path output;
  FeatureOptions features;
  TrainOptions training;
};

/// Stage, share done and time left on standard error, where that is a terminal.
Progress terminal_progress() {
  if (isatty(STDERR_FILENO) == 0) return {};
  return [stage = std::string(), watch = Stopwatch()](const ProgressReport& now) mutable {
    if (stage != now.stage) {
      stage = now.stage;
      watch = Stopwatch();
    }
    const double done = now.total == 0 ? 0 : static_cast<double>(now.done) / static_cast<double>(now.total);
    const double left_s = done > 0 ? watch.wall_s() * (1 - done) / done : 0;
    fmt::print(stderr, "\r{}: {:3.0f} %, {:.0f} s left \033[K{}", stage, 100 * done, left_s,
               done < 1 ? "" : "\n");
    std::fflush(stderr);
    return true;
  };
}

void print_stats(const Vocabulary& vocabulary) {
  const VocabularyTree& tree = vocabulary.tree();
  const VocabularyStats stats = vocabulary_stats(vocabulary);
  fmt::print("descriptors    binary, 256 bits\n");
  fmt::print("words          {}\n", vocabulary.word_count());
  fmt::print("tree           at most {} children, {} levels\n", tree.branching, tree.depth);
  for (size_t level = 1; level < stats.levels.size(); ++level) {
    fmt::print("  level {}      {} nodes, {} of them words\n", level, stats.levels[level].nodes,
               stats.levels[level].words);
  }
  fmt::print("trained on     {} descriptors of {} images\n", stats.descriptors, tree.images);
  fmt::print("entropy        {:.3f} bits a word\n", stats.entropy_bits);
  fmt::print("balance        {:.4f} (1 = all words used equally often; the most used: {} times)\n",
             stats.balance, stats.most_uses);
  fmt::print("idf            {:.3f} to {:.3f}, median {:.3f}\n", stats.idf_min, stats.idf_max,
             stats.idf_median);
}

ImageDescriptors describe(const std::vector<std::filesystem::path>& inputs, const TrainArguments& arguments,
                          const Progress& progress) {
  auto described =
      describe_images(list_images(inputs), arguments.features, arguments.training.threads, progress);
  if (!described.unreadable.empty()) {
    log::warn("{} of the files are not readable images and were skipped, the first: {}",
              described.unreadable.size(), described.unreadable.front().string());
  }
  return described;
}

void train(const TrainArguments& arguments) {
  const Progress progress = terminal_progress();
  const Stopwatch describing;
  const auto described = describe(arguments.images, arguments, progress);
  const double describing_s = describing.wall_s();
  const Stopwatch training;
  const Vocabulary vocabulary = train_vocabulary(described.of_images, arguments.training, progress);
  const double training_s = training.wall_s();
  write_vocabulary(arguments.output, vocabulary);

  print_stats(vocabulary);
  fmt::print("skipped        {} unreadable images\n", described.unreadable.size());
  fmt::print("error          {:.3f} bits from a descriptor to its word, mean\n",
             quantization_error(vocabulary, described.of_images));
  if (!arguments.held_out.empty()) {
    const auto others = describe(arguments.held_out, arguments, progress);
    fmt::print("held-out error {:.3f} bits, {} images\n", quantization_error(vocabulary, others.of_images),
               others.of_images.size());
  }
  fmt::print("time           {:.2f} s for the descriptors, {:.2f} s for the tree\n", describing_s,
             training_s);
  fmt::print("written        {}, {} bytes\n", arguments.output.string(),
             std::filesystem::file_size(arguments.output));
}

void info(const std::string& name) {
  const Stopwatch watch;
  const Vocabulary vocabulary = name == kDefaultName ? load_default_vocabulary() : read_vocabulary(name);
  const double loading_s = watch.wall_s();
  print_stats(vocabulary);
  fmt::print("loaded in      {:.2f} ms\n", 1000 * loading_s);
}

/// The options that are fields of `options`, under the flags given by their keys.
template <class Options>
void add_fields(CLI::App& command, Options& options, const std::map<std::string, std::string>& flags_of) {
  for (const auto& entry : option_entries(options)) {
    const auto flags = flags_of.find(entry.key);
    if (flags == flags_of.end()) continue;
    const std::string help =
        fmt::format("{} ({}; default {})", entry.help, entry.expected, to_text(entry.value));
    command.add_option_function<std::string>(flags->second, entry.set, help);
  }
}

void add_train_command(CLI::App& vocab) {
  CLI::App* command = vocab.add_subcommand("train", "Train a dictionary on images");
  auto arguments = std::make_shared<TrainArguments>();
  arguments->training.threads = hardware_threads();
  command->add_option("images", arguments->images, "image files, folders of images, sequences in TUM layout")
      ->required();
  command->add_option("-o,--output", arguments->output, "the dictionary file to write")->required();
  add_fields(*command, arguments->features, {{"kind", "--feature"}, {"count", "--count"}});
  add_fields(*command, arguments->training,
             {{"branching", "-k,--branching"},
              {"depth", "-L,--depth"},
              {"seeding", "--init"},
              {"candidates", "--candidates"},
              {"iterations", "--iterations"},
              {"min_split", "--min-split"},
              {"seed", "--seed"},
              {"threads", "--threads"}});
  command->add_option("--held-out", arguments->held_out,
                      "other images, to measure the quantisation error on");
  command->callback([arguments] { train(*arguments); });
}

void add_info_command(CLI::App& vocab) {
  CLI::App* command = vocab.add_subcommand("info", "Tell what is in a dictionary");
  auto name = std::make_shared<std::string>(kDefaultName);
  command->add_option("file", *name, "a dictionary file, or 'default' for the one built in")
      ->capture_default_str();
  command->callback([name] { info(*name); });
}

}  // namespace

void add_vocab_command(CLI::App& app) {
  CLI::App* vocab = app.add_subcommand("vocab", "Dictionaries of visual words, for finding places again");
  vocab->require_subcommand(1);
  add_train_command(*vocab);
  add_info_command(*vocab);
}

}  // namespace kinloop
