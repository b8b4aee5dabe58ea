#include "apps/vocab/vocab_train.hpp"

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/shared/command_line/common_options.hpp"
#include "apps/shared/terminal/progress_bar.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/anonymous_temp_file.hpp"
#include "kinloop/core/files/output_file.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/options.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/place/vocabulary/vocabulary_file.hpp"
#include "session/store/command_files.hpp"
#include "tools/vocabulary_training/communicator.hpp"
#include "tools/vocabulary_training/descriptors/descriptor_file.hpp"
#include "tools/vocabulary_training/descriptors/training_images.hpp"
#include "tools/vocabulary_training/descriptors/training_set.hpp"
#include "tools/vocabulary_training/trainer.hpp"
#include "tools/vocabulary_training/vocabulary_stats.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

size_t half_of_memory_mb() {
  const auto pages = static_cast<size_t>(sysconf(_SC_PHYS_PAGES));
  return pages * static_cast<size_t>(sysconf(_SC_PAGESIZE)) / 2 >> 20;
}

/// The images to describe, and how.
struct InputArguments {
  std::vector<fs::path> inputs;
  fs::path output;
  FeatureOptions features;
  bool euclidean = false;
  int threads = hardware_threads();
  bool quiet = false;
};

struct TrainArguments {
  InputArguments input;
  std::vector<fs::path> held_out;
  TrainOptions training;
  size_t memory_mb = half_of_memory_mb();
  fs::path scratch = temporary_folder();
};

DescribeOptions make_description(const InputArguments& arguments) {
  const auto kind =
      descriptor_kind(arguments.features, arguments.euclidean ? Metric::kEuclidean : Metric::kHamming);
  if (!kind) throw UsageError("--euclidean requires --feature sift or surf: ORB's descriptors are binary");
  return {arguments.features, *kind, arguments.threads};
}

/// Throws UsageError if the output is an input, InputError unless it can be written, and read again for its
/// figures.
void require_regular_output(const fs::path& path, std::span<const fs::path> inputs,
                            std::span<const fs::path> held_out = {}) {
  CommandFiles files{.outputs = {{"-o", path}}};
  for (const auto& list : {list_training_input(inputs), list_training_input(held_out)}) {
    files.inputs.insert(files.inputs.end(), list.images.begin(), list.images.end());
    files.inputs.insert(files.inputs.end(), list.descriptor_files.begin(), list.descriptor_files.end());
  }
  require_outputs(files);
  if (output_place(path).is_stream)
    throw InputError(fmt::format("{}: is not a file; give the name of a file", path.string()));
}

void warn_of_unreadable(const std::vector<fs::path>& unreadable) {
  if (unreadable.empty()) return;
  log::warn("skipped {} files that are not readable images, the first: {}", unreadable.size(),
            unreadable.front().string());
}

/// Mean distance of the descriptors of held-out images to their words.
void print_held_out_error(const Vocabulary& vocabulary, const TrainArguments& arguments,
                          const DescribeOptions& description, const Progress& progress) {
  std::vector<cv::Mat> descriptors;
  describe_images(list_training_input(arguments.held_out).images, description, progress,
                  [&](const fs::path&, const std::optional<cv::Mat>& of_image) {
                    if (of_image) descriptors.push_back(*of_image);
                  });
  fmt::print("held-out error {:.3f} {}, {} images\n", quantization_error(vocabulary, descriptors),
             vocabulary.descriptors().distance, descriptors.size());
}

void train(const TrainArguments& arguments) {
  const auto ranks = join_mpi();
  const bool first = ranks->rank() == 0;
  const Progress progress = make_progress_bar(arguments.input.quiet || !first);
  if (first) require_regular_output(arguments.input.output, arguments.input.inputs, arguments.held_out);
  const DescribeOptions description = make_description(arguments.input);
  ScratchMemory memory(arguments.memory_mb << 20, arguments.scratch);

  const Stopwatch describing;
  auto described =
      read_training_set(list_training_input(arguments.input.inputs), description, progress, *ranks, &memory);
  warn_of_unreadable(described.unreadable);
  const uint64_t skipped = ranks->all_reduce_sum(described.unreadable.size());
  const double describing_s = describing.wall_s();
  const Stopwatch training;
  TrainOptions options = arguments.training;
  options.threads = arguments.input.threads;
  const Vocabulary vocabulary = train_vocabulary(std::move(described.set), options, progress, *ranks);
  const double training_s = training.wall_s();
  if (!first) return;
  write_vocabulary(arguments.input.output, vocabulary);

  print_stats(vocabulary);
  fmt::print("skipped        {} unreadable images\n", skipped);
  if (!arguments.held_out.empty()) print_held_out_error(vocabulary, arguments, description, progress);
  fmt::print("time           {:.2f} s for descriptors, {:.2f} s for the tree\n", describing_s, training_s);
  print_text(fmt::format("written        {}, {} bytes\n", arguments.input.output.string(),
                         fs::file_size(arguments.input.output)));
}

void describe(const InputArguments& arguments) {
  const DescribeOptions description = make_description(arguments);
  require_regular_output(arguments.output, arguments.inputs);
  const TrainingInput input = list_training_input(arguments.inputs);
  if (!input.descriptor_files.empty()) {
    throw UsageError(fmt::format("{}: contains descriptors already; use it with 'kinloop vocab train'",
                                 input.descriptor_files.front().string()));
  }
  DescriptorFileWriter writer(arguments.output, description.kind);
  std::vector<fs::path> unreadable;
  describe_images(input.images, description, make_progress_bar(arguments.quiet),
                  [&](const fs::path& path, const std::optional<cv::Mat>& descriptors) {
                    if (descriptors) {
                      writer.append(*descriptors);
                    } else {
                      unreadable.push_back(path);
                    }
                  });
  writer.commit();
  warn_of_unreadable(unreadable);
  const DescriptorFile file(arguments.output);
  print_text(fmt::format("{} descriptors of {} images ({}), {} unreadable, in {}\n", file.rows(),
                         file.images(), descriptor_traits(file.kind()).name, unreadable.size(),
                         arguments.output.string()));
}

/// Adds the fields of `options` as command line options, with flags given by their keys.
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

void add_input_options(CLI::App& command, InputArguments& arguments) {
  command
      .add_option("inputs", arguments.inputs,
                  "image files, folders of images, sequences in TUM layout, files of descriptors (.kindesc)")
      ->required();
  command.add_option("-o,--output", arguments.output, "file to write")->required();
  add_fields(command, arguments.features, {{"kind", "--feature"}, {"count", "--count"}});
  command.add_flag("--euclidean", arguments.euclidean,
                   "use raw SIFT or SURF descriptors with Euclidean distance instead of 256-bit ones");
  add_threads_option(command, arguments.threads, "number of threads; does not affect the result");
  add_quiet_option(command, arguments.quiet);
}

}  // namespace

void add_train_command(CLI::App& vocab) {
  CLI::App* command = vocab.add_subcommand(
      "train", "Train a vocabulary. Under mpirun, all processes share the work; the file is the same.");
  auto arguments = std::make_shared<TrainArguments>();
  add_input_options(*command, arguments->input);
  add_fields(*command, arguments->training,
             {{"branching", "-k,--branching"},
              {"depth", "-L,--depth"},
              {"seeding", "--init"},
              {"candidates", "--candidates"},
              {"iterations", "--iterations"},
              {"min_split", "--min-split"},
              {"seed", "--seed"}});
  command->add_option("--held-out", arguments->held_out,
                      "held-out images for measuring the quantisation error");
  command
      ->add_option("--memory", arguments->memory_mb,
                   "MB of descriptors to keep in memory; the rest goes to files")
      ->capture_default_str();
  command->add_option("--scratch", arguments->scratch, "folder for these files")->capture_default_str();
  command->callback([arguments] { train(*arguments); });
}

void add_describe_command(CLI::App& vocab) {
  CLI::App* command =
      vocab.add_subcommand("describe", "Write the descriptors of images to a file for later training");
  auto arguments = std::make_shared<InputArguments>();
  add_input_options(*command, *arguments);
  command->callback([arguments] { describe(*arguments); });
}

void print_stats(const Vocabulary& vocabulary) {
  const VocabularyView& tree = vocabulary.tree();
  const VocabularyStats stats = vocabulary_stats(vocabulary);
  fmt::print("descriptors    {}\n", vocabulary.descriptors().name);
  fmt::print("words          {}\n", vocabulary.word_count());
  fmt::print("tree           at most {} children, {} level{}\n", tree.branching, tree.depth,
             tree.depth == 1 ? " (flat)" : "s");
  for (size_t level = 1; level < stats.levels.size(); ++level) {
    fmt::print("  level {}      {} nodes, {} of them words\n", level, stats.levels[level].nodes,
               stats.levels[level].words);
  }
  if (stats.descriptors > 0) {
    fmt::print("trained on     {} descriptors of {} images\n", stats.descriptors, tree.images);
    fmt::print("entropy        {:.3f} bits per word\n", stats.entropy_bits);
    fmt::print("balance        {:.4f} (1 = all words equally frequent; most frequent: {} times)\n",
               stats.balance, stats.max_use_count);
  } else {
    fmt::print("trained on     unknown (imported vocabulary without statistics)\n");
  }
  fmt::print("idf            {:.3f} to {:.3f}, median {:.3f}\n", stats.idf_min, stats.idf_max,
             stats.idf_median);
}

}  // namespace kinloop
