#pragma once
// kinloop vocab train and describe: compute vocabularies, or descriptor files, from images.

#include <CLI/CLI.hpp>

#include "kinloop/place/vocabulary/vocabulary.hpp"

namespace kinloop {

void add_train_command(CLI::App& vocab);
void add_describe_command(CLI::App& vocab);

/// Prints the output of `kinloop vocab info`.
void print_stats(const Vocabulary& vocabulary);

}  // namespace kinloop
