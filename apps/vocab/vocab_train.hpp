#pragma once
// kinloop vocab train and describe: images into vocabularies, or into files of descriptors.

#include <CLI/CLI.hpp>

#include "kinloop/place/vocabulary.hpp"

namespace kinloop {

void add_train_command(CLI::App& vocab);
void add_describe_command(CLI::App& vocab);

/// What `kinloop vocab info` says of a vocabulary, on standard output.
void print_stats(const Vocabulary& vocabulary);

}  // namespace kinloop
