#include "kinloop/place/vocabulary_file.hpp"

#include <bit>
#include <concepts>
#include <cstring>

#include <fmt/format.h>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/text_file.hpp"

namespace kinloop {
namespace {

constexpr std::string_view kMagic("KINVOC\r\n", 8);  // the line end shows a transfer in text mode
constexpr uint32_t kVersion = 1;
constexpr uint32_t kBinary256 = 1;  ///< descriptors of 256 bits under the Hamming distance
constexpr size_t kHeaderBytes = 48;
constexpr size_t kChecksumOffset = 40;
constexpr const char* kRemedy = "train it again with 'kinloop vocab train', or copy it anew";

/// Little-endian integers, whatever the machine.
template <std::unsigned_integral T>
T get(const char* bytes) {
  T value = 0;
  for (size_t i = 0; i < sizeof(T); ++i) {
    value = static_cast<T>(value | T{static_cast<unsigned char>(bytes[i])} << (8 * i));
  }
  return value;
}

template <std::unsigned_integral T>
void put(std::string& bytes, T value) {
  for (size_t i = 0; i < sizeof(T); ++i) bytes.push_back(static_cast<char>((value >> (8 * i)) & 0xff));
}

/// FNV-1a (Fowler, Noll, Vo) over 64-bit words instead of bytes, for speed; the rotation lets the top bits of
/// a word, too, reach all later ones. Each step is a bijection: an altered word always alters the sum.
uint64_t checksum(std::string_view bytes, uint64_t sum) {
  constexpr uint64_t kPrime = 0x100000001b3;
  constexpr int kRotation = 29;
  for (size_t i = 0; i + 8 <= bytes.size(); i += 8) {
    sum = std::rotl((sum ^ get<uint64_t>(bytes.data() + i)) * kPrime, kRotation);
  }
  return sum;
}

/// Of everything but the sum itself.
uint64_t file_checksum(std::string_view bytes) {
  constexpr uint64_t kOffsetBasis = 0xcbf29ce484222325;
  return checksum(bytes.substr(kHeaderBytes), checksum(bytes.substr(0, kChecksumOffset), kOffsetBasis));
}

struct Header {
  uint32_t version = kVersion;
  uint32_t kind = kBinary256;
  uint32_t branching = 0;
  uint32_t depth = 0;
  uint32_t images = 0;
  uint32_t nodes = 0;
  uint32_t words = 0;
  uint32_t reserved = 0;

  /// Whole file: header, centres, idf, uses, child counts, zeros up to a multiple of 8.
  [[nodiscard]] uint64_t file_bytes() const {
    const uint64_t bytes = kHeaderBytes + uint64_t{nodes} * (kOrbBytes + 1) + uint64_t{words} * 8;
    return (bytes + 7) / 8 * 8;
  }
};

Header get_header(std::string_view bytes) {
  const auto field = [&](size_t i) { return get<uint32_t>(bytes.data() + kMagic.size() + 4 * i); };
  return {field(0), field(1), field(2), field(3), field(4), field(5), field(6), field(7)};
}

/// The header, once all that can be told without reading on is as it should be.
Header checked_header(std::string_view bytes, const std::string& name) {
  const auto fail = [&](const std::string& what) { throw InputError(fmt::format("{}: {}", name, what)); };
  if (bytes.substr(0, kMagic.size()) != kMagic)
    fail("not a kinloop dictionary; make one with 'kinloop vocab train'");
  if (bytes.size() < kHeaderBytes) fail(fmt::format("cut short within its header; {}", kRemedy));
  const Header header = get_header(bytes);
  if (header.version != kVersion) {
    fail(fmt::format("dictionary format {}, this program reads format {}; {}", header.version, kVersion,
                     kRemedy));
  }
  if (header.kind != kBinary256) {
    fail(fmt::format("a dictionary of descriptor kind {}, expected {} (ORB); {}", header.kind, kBinary256,
                     kRemedy));
  }
  if (bytes.size() != header.file_bytes()) {
    fail(fmt::format("{} bytes, expected {}: cut short or appended to; {}", bytes.size(), header.file_bytes(),
                     kRemedy));
  }
  if (get<uint64_t>(bytes.data() + kChecksumOffset) != file_checksum(bytes)) {
    fail(fmt::format("damaged: its checksum does not fit its content; {}", kRemedy));
  }
  return header;
}

}  // namespace

std::string serialize_vocabulary(const Vocabulary& vocabulary) {
  const VocabularyTree& tree = vocabulary.tree();
  Header header;
  header.branching = static_cast<uint32_t>(tree.branching);
  header.depth = static_cast<uint32_t>(tree.depth);
  header.images = tree.images;
  header.nodes = static_cast<uint32_t>(tree.child_counts.size());
  header.words = static_cast<uint32_t>(tree.idf.size());
  std::string bytes(kMagic);
  bytes.reserve(header.file_bytes());
  for (const uint32_t field : {header.version, header.kind, header.branching, header.depth, header.images,
                               header.nodes, header.words, header.reserved}) {
    put(bytes, field);
  }
  put(bytes, uint64_t{0});  // the checksum, known at the end
  for (const auto& centre : tree.centres) bytes.append(centre.begin(), centre.end());
  for (const float idf : tree.idf) put(bytes, std::bit_cast<uint32_t>(idf));
  for (const uint32_t uses : tree.uses) put(bytes, uses);
  bytes.append(tree.child_counts.begin(), tree.child_counts.end());
  bytes.resize(header.file_bytes(), '\0');
  std::string sum;
  put(sum, file_checksum(bytes));
  return bytes.replace(kChecksumOffset, sum.size(), sum);
}

Vocabulary parse_vocabulary(std::string_view bytes, const std::string& name) {
  const Header header = checked_header(bytes, name);
  VocabularyTree tree;
  tree.branching = static_cast<int>(header.branching);
  tree.depth = static_cast<int>(header.depth);
  tree.images = header.images;
  const char* at = bytes.data() + kHeaderBytes;
  tree.centres.resize(header.nodes);
  if (header.nodes > 0) std::memcpy(tree.centres.data(), at, size_t{header.nodes} * kOrbBytes);
  at += size_t{header.nodes} * kOrbBytes;
  tree.idf.reserve(header.words);
  for (size_t i = 0; i < header.words; ++i, at += 4)
    tree.idf.push_back(std::bit_cast<float>(get<uint32_t>(at)));
  tree.uses.reserve(header.words);
  for (size_t i = 0; i < header.words; ++i, at += 4) tree.uses.push_back(get<uint32_t>(at));
  tree.child_counts.assign(at, at + header.nodes);
  if (const auto defect = defect_of(tree)) {
    throw InputError(fmt::format("{}: {} makes no sense; {}", name, *defect, kRemedy));
  }
  return Vocabulary(std::move(tree));
}

void write_vocabulary(const std::filesystem::path& path, const Vocabulary& vocabulary) {
  write_file(path, serialize_vocabulary(vocabulary));
}

Vocabulary read_vocabulary(const std::filesystem::path& path) {
  return parse_vocabulary(read_file(path), path.string());
}

}  // namespace kinloop
