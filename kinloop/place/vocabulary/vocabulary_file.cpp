#include "kinloop/place/vocabulary/vocabulary_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <numeric>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"

namespace kinloop {
namespace {

static_assert(std::endian::native == std::endian::little, "vocabularies are used as they lie in the file");

constexpr std::string_view kMagic("KINVOC\r\n", 8);  // the line end reveals a transfer in text mode
constexpr uint32_t kVersion = 2;
constexpr const char* kRemedy = "train it again with 'kinloop vocab train', or copy it again";

struct Header {
  std::array<char, 8> magic{};
  uint32_t version = kVersion;
  uint32_t kind = 0;
  uint32_t branching = 0;
  uint32_t depth = 0;
  uint32_t images = 0;
  uint32_t nodes = 0;
  uint32_t words = 0;
  uint32_t descriptor_bytes = 0;
  uint64_t checksum = 0;  ///< over everything else

  /// Whole file: header, centres, child counts, idf, use counts, zero padding to a multiple of 8.
  [[nodiscard]] uint64_t file_bytes() const {
    const uint64_t bytes =
        sizeof(Header) + uint64_t{nodes} * (uint64_t{descriptor_bytes} + 4) + uint64_t{words} * 8;
    return (bytes + 7) / 8 * 8;
  }
};
static_assert(sizeof(Header) == 48);

/// FNV-1a (Fowler, Noll, Vo) over 64-bit words instead of bytes, for speed; the rotation lets the top bits of
/// a word affect all later ones, too. Each step is a bijection, so an altered word always alters the sum.
uint64_t with_word(uint64_t sum, uint64_t word) {
  constexpr uint64_t kPrime = 0x100000001b3;
  constexpr int kRotation = 29;
  return std::rotl((sum ^ word) * kPrime, kRotation);
}

/// Word i goes into sum i mod 4, so that four steps run in parallel.
using Sums = std::array<uint64_t, 4>;

void add_words(Sums& sums, std::string_view bytes) {
  const size_t words = bytes.size() / 8;
  const auto word = [&](size_t i) {
    uint64_t value = 0;
    std::memcpy(&value, bytes.data() + 8 * i, sizeof value);
    return value;
  };
  Sums now = sums;
  size_t i = 0;
  for (; i + now.size() <= words; i += now.size()) {
    for (size_t j = 0; j < now.size(); ++j) now[j] = with_word(now[j], word(i + j));
  }
  for (; i < words; ++i) now[i % now.size()] = with_word(now[i % now.size()], word(i));
  sums = now;
}

/// Covers everything but the checksum itself, which ends the header.
uint64_t file_checksum(std::string_view bytes) {
  constexpr uint64_t kOffsetBasis = 0xcbf29ce484222325;
  Sums sums;
  sums.fill(kOffsetBasis);
  add_words(sums, bytes.substr(0, sizeof(Header) - sizeof(Header::checksum)));
  add_words(sums, bytes.substr(sizeof(Header)));
  return std::accumulate(sums.begin(), sums.end(), kOffsetBasis, with_word);
}

[[noreturn]] void fail(const std::string& name, const std::string& what) {
  throw InputError(fmt::format("{}: {}; {}", name, what, kRemedy));
}

/// Returns the header after checking everything that can be checked without the body.
Header checked_header(std::string_view bytes, const std::string& name) {
  if (bytes.substr(0, kMagic.size()) != kMagic) fail(name, "not a kinloop vocabulary");
  if (bytes.size() < sizeof(Header)) fail(name, "truncated within its header");
  Header header;
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.version != kVersion) {
    fail(name, fmt::format("vocabulary format {}, this program reads format {}", header.version, kVersion));
  }
  const auto kind = descriptor_kind(header.kind);
  if (!kind) fail(name, fmt::format("unknown descriptor kind {}", header.kind));
  if (header.descriptor_bytes != descriptor_traits(*kind).bytes) {
    fail(name, fmt::format("descriptors of {} bytes, expected {}", header.descriptor_bytes,
                           descriptor_traits(*kind).bytes));
  }
  if (bytes.size() != header.file_bytes()) {
    fail(name,
         fmt::format("{} bytes, expected {}: truncated or appended to", bytes.size(), header.file_bytes()));
  }
  if (header.checksum != file_checksum(bytes)) {
    fail(name, "damaged: checksum mismatch");
  }
  return header;
}

template <class T>
void append(std::string& bytes, std::span<const T> values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

/// Removes and returns `count` values from the front of `bytes`.
template <class T>
std::span<const T> take(std::string_view& bytes, size_t count) {
  const std::span values(reinterpret_cast<const T*>(bytes.data()), count);
  bytes.remove_prefix(values.size_bytes());
  return values;
}

}  // namespace

std::string serialize_vocabulary(const Vocabulary& vocabulary) {
  const VocabularyView& tree = vocabulary.tree();
  Header header;
  std::copy(kMagic.begin(), kMagic.end(), header.magic.begin());
  header.kind = static_cast<uint32_t>(tree.kind);
  header.branching = static_cast<uint32_t>(tree.branching);
  header.depth = static_cast<uint32_t>(tree.depth);
  header.images = tree.images;
  header.nodes = static_cast<uint32_t>(tree.child_counts.size());
  header.words = static_cast<uint32_t>(tree.idf.size());
  header.descriptor_bytes = static_cast<uint32_t>(vocabulary.descriptors().bytes);
  std::string bytes;
  bytes.reserve(header.file_bytes());
  append(bytes, std::span<const Header>(&header, 1));
  append(bytes, tree.centres);
  append(bytes, tree.child_counts);
  append(bytes, tree.idf);
  append(bytes, tree.use_counts);
  bytes.resize(header.file_bytes(), '\0');
  const uint64_t sum = file_checksum(bytes);
  std::memcpy(bytes.data() + offsetof(Header, checksum), &sum, sizeof sum);
  return bytes;
}

Vocabulary parse_vocabulary(std::string_view bytes, const std::string& name,
                            std::shared_ptr<const void> owner) {
  const Header header = checked_header(bytes, name);
  require(reinterpret_cast<uintptr_t>(bytes.data()) % alignof(uint32_t) == 0,
          "parse_vocabulary: the bytes must be aligned");
  VocabularyView tree;
  tree.kind = *descriptor_kind(header.kind);
  tree.branching = static_cast<int>(header.branching);
  tree.depth = static_cast<int>(header.depth);
  tree.images = header.images;
  bytes.remove_prefix(sizeof(Header));
  tree.centres = take<uint8_t>(bytes, size_t{header.nodes} * header.descriptor_bytes);
  tree.child_counts = take<uint32_t>(bytes, header.nodes);
  tree.idf = take<float>(bytes, header.words);
  tree.use_counts = take<uint32_t>(bytes, header.words);
  if (const auto defect = find_defect(tree)) fail(name, *defect + " is invalid");
  return {tree, std::move(owner)};
}

void write_vocabulary(const std::filesystem::path& path, const Vocabulary& vocabulary) {
  write_file(path, serialize_vocabulary(vocabulary));
}

Vocabulary read_vocabulary(const std::filesystem::path& path) {
  const auto bytes = std::make_shared<const std::string>(read_file(path));
  return parse_vocabulary(*bytes, path.string(), bytes);
}

}  // namespace kinloop
