#include "tools/vocabulary_training/tree_level.hpp"

#include <algorithm>

#include "tools/vocabulary_training/communicator.hpp"

namespace kinloop {
namespace {

void append(TrainingSet& to, std::span<const uint8_t> rows, std::span<const uint32_t> image_of) {
  to.rows.insert(to.rows.end(), rows.begin(), rows.end());
  to.image_of.insert(to.image_of.end(), image_of.begin(), image_of.end());
}

std::span<const uint8_t> rows_of(const TrainingSet& set, const TreeLevelNode& node) {
  const size_t bytes = descriptor_traits(set.kind).bytes;
  return std::span(set.rows).subspan(node.begin * bytes, node.size() * bytes);
}

std::span<const uint32_t> images_of(const TrainingSet& set, const TreeLevelNode& node) {
  return std::span(set.image_of).subspan(node.begin, node.size());
}

/// Assigns owners to nodes that have become small, as evenly as their order allows; returns which nodes these
/// are.
std::vector<bool> choose_owners(std::vector<TreeLevelNode>& level, uint64_t small, int process_count) {
  std::vector<bool> fresh(level.size());
  uint64_t points = 0, before = 0;
  for (size_t i = 0; i < level.size(); ++i) {
    fresh[i] = level[i].shared() && level[i].total <= small;
    if (fresh[i]) points += level[i].total;
  }
  for (size_t i = 0; i < level.size(); ++i) {
    if (!fresh[i]) continue;
    level[i].owner =
        static_cast<int>(before * static_cast<uint64_t>(process_count) / std::max<uint64_t>(points, 1));
    before += level[i].total;
  }
  return fresh;
}

}  // namespace

void distribute_nodes(TrainingSet& set, std::vector<TreeLevelNode>& level, uint64_t small,
                      const Communicator& communicator) {
  const auto fresh = choose_owners(level, small, communicator.size());
  if (communicator.size() == 1) return;  // all points are local
  std::vector<Message> outgoing(static_cast<size_t>(communicator.size()));
  for (size_t i = 0; i < level.size(); ++i) {
    if (!fresh[i]) continue;
    Message& message = outgoing[static_cast<size_t>(level[i].owner)];
    put(message, uint64_t{level[i].size()});
    put(message, images_of(set, level[i]));
    put(message, rows_of(set, level[i]));
  }
  const auto incoming = communicator.exchange(std::move(outgoing));
  std::vector<MessageReader> readers(incoming.begin(), incoming.end());

  TrainingSet kept(set.kind, set.memory());
  kept.images = set.images;
  for (size_t i = 0; i < level.size(); ++i) {
    TreeLevelNode& node = level[i];
    const size_t begin = kept.size();
    if (!fresh[i]) {
      append(kept, rows_of(set, node), images_of(set, node));
    } else if (node.owner == communicator.rank()) {
      for (MessageReader& reader : readers) {
        const auto count = reader.read<uint64_t>();
        const auto image_of = reader.read<uint32_t>(count);
        append(kept, reader.read<uint8_t>(count * descriptor_traits(set.kind).bytes), image_of);
      }
    }
    node.begin = begin;
    node.end = kept.size();
  }
  set.rows.swap(kept.rows);
  set.image_of.swap(kept.image_of);
}

}  // namespace kinloop
