#include "tools/vocabulary_training/descriptors/descriptor_file.hpp"

#include <array>
#include <cstring>
#include <numeric>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"

namespace kinloop {
namespace {

constexpr std::array<char, 8> kMagic = {'K', 'I', 'N', 'D', 'E', 'S', 'C', '\n'};
constexpr uint32_t kVersion = 1;

/// The rows follow, then the number of rows of each image (4 bytes each).
struct Header {
  std::array<char, 8> magic = kMagic;
  uint32_t version = kVersion;
  uint32_t kind = 0;
  uint64_t images = 0;
  uint64_t rows = 0;
};
static_assert(sizeof(Header) == 32);

void write(std::ostream& stream, const void* bytes, size_t size) {
  stream.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
}

}  // namespace

DescriptorFileWriter::DescriptorFileWriter(const std::filesystem::path& path, DescriptorKind kind)
    : file_(path), kind_(kind) {
  const Header later;
  write(file_.stream(), &later, sizeof later);
}

void DescriptorFileWriter::append(const cv::Mat& descriptors) {
  const size_t bytes = descriptor_traits(kind_).bytes;
  require(descriptors.empty() ||
              (descriptors.type() == CV_8UC1 && static_cast<size_t>(descriptors.cols) == bytes),
          "the descriptors are of another kind than the file's");
  for (int row = 0; row < descriptors.rows; ++row) write(file_.stream(), descriptors.ptr(row), bytes);
  counts_.push_back(static_cast<uint32_t>(descriptors.rows));
}

void DescriptorFileWriter::commit() {
  Header header;
  header.kind = static_cast<uint32_t>(kind_);
  header.images = counts_.size();
  header.rows = std::accumulate(counts_.begin(), counts_.end(), uint64_t{0});
  write(file_.stream(), counts_.data(), counts_.size() * sizeof(uint32_t));
  file_.stream().seekp(0);
  write(file_.stream(), &header, sizeof header);
  file_.commit();
}

DescriptorFile::DescriptorFile(std::filesystem::path path) : path_(std::move(path)) {
  require_regular_file(path_);
  file_.open(path_, std::ios::binary);
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(path_, error);
  if (!file_ || error) throw InputError(fmt::format("{}: cannot be read; check the path", path_.string()));
  Header header;
  if (size < sizeof header) fail("truncated header");
  read(0, &header, sizeof header);
  if (header.magic != kMagic) fail("not a descriptor file");
  if (header.version != kVersion) {
    fail(fmt::format("format {}, this program reads format {}", header.version, kVersion));
  }
  const auto kind = descriptor_kind(header.kind);
  if (!kind) fail(fmt::format("unknown descriptor kind {}", header.kind));
  kind_ = *kind;
  const size_t left = size - sizeof header, row_bytes = descriptor_traits(kind_).bytes;
  if (header.rows > left / row_bytes || header.images > left / sizeof(uint32_t) ||
      header.rows * row_bytes + header.images * sizeof(uint32_t) != left) {
    fail("truncated or appended to");
  }
  std::vector<uint32_t> counts(header.images);
  read(sizeof header + header.rows * row_bytes, counts.data(), counts.size() * sizeof(uint32_t));
  first_row_.resize(counts.size() + 1, 0);
  std::inclusive_scan(counts.begin(), counts.end(), first_row_.begin() + 1, std::plus<>(), size_t{0});
  if (rows() != header.rows) fail("the descriptor counts of its images do not add up");
}

void DescriptorFile::fail(const std::string& what) const {
  throw InputError(
      fmt::format("{}: {}; create it again with 'kinloop vocab describe'", path_.string(), what));
}

void DescriptorFile::read(uint64_t offset, void* bytes, size_t size) {
  file_.seekg(static_cast<std::streamoff>(offset));
  file_.read(static_cast<char*>(bytes), static_cast<std::streamsize>(size));
  if (!file_) fail("truncated while it was read");
}

cv::Mat DescriptorFile::descriptors_of_image(size_t image) {
  require(image < images(), "DescriptorFile: no such image");
  const size_t row_bytes = descriptor_traits(kind_).bytes, begin = first_row_[image];
  cv::Mat rows(static_cast<int>(first_row_[image + 1] - begin), static_cast<int>(row_bytes), CV_8UC1);
  read(sizeof(Header) + begin * row_bytes, rows.data, rows.total());
  return rows;
}

}  // namespace kinloop
