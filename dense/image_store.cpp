#include "dense/image_store.hpp"

#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/anonymous_temp_file.hpp"

namespace kinloop {
namespace {

[[noreturn]] void throw_no_room() {
  require_temporary_folder();
  throw OutputError(
      fmt::format("{}: no space for the images of the map; free some space, set TMPDIR to another folder, or "
                  "raise --set dense.image_memory_mib and dense.surfel_memory_mib",
                  temporary_folder().string()));
}

/// Opens an unnamed file in the temporary folder; null on failure.
std::FILE* open_spill_file() {
  const int descriptor = open_anonymous_temp_file(temporary_folder());
  return descriptor < 0 ? nullptr : fdopen(descriptor, "w+b");
}

}  // namespace

size_t ByteStore::add(std::vector<uint8_t> bytes) {
  Entry entry;
  if (bytes_in_memory_ + bytes.size() > memory_limit_bytes_) {
    entry.file_offset = bytes_on_disk_;
    entry.file_bytes = bytes.size();
    spill(bytes);
  } else {
    bytes_in_memory_ += bytes.size();
    entry.bytes = std::move(bytes);
  }
  entries_.push_back(std::move(entry));
  return entries_.size() - 1;
}

std::vector<uint8_t> ByteStore::load(size_t index) const {
  require(index < entries_.size(), "ByteStore: no such piece");
  const Entry& entry = entries_[index];
  if (!entry.bytes.empty()) return entry.bytes;
  std::vector<uint8_t> bytes(entry.file_bytes);
  // pread does not move the file position, so threads do not disturb each other.
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t got = pread(fileno(file_.get()), bytes.data() + done, bytes.size() - done,
                              static_cast<off_t>(entry.file_offset + done));
    if (got <= 0) throw_no_room();
    done += static_cast<size_t>(got);
  }
  return bytes;
}

void ByteStore::spill(const std::vector<uint8_t>& bytes) {
  if (!file_) file_.reset(open_spill_file());
  if (!file_) throw_no_room();
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) == bytes.size();
  if (!written || std::fflush(file_.get()) != 0) throw_no_room();
  bytes_on_disk_ += bytes.size();
}

size_t ImageStore::add(const EncodedImages& images) {
  std::vector<uint8_t> bytes;
  bytes.reserve(images.color.size() + images.depth.size());
  bytes.insert(bytes.end(), images.color.begin(), images.color.end());
  bytes.insert(bytes.end(), images.depth.begin(), images.depth.end());
  sizes_.push_back({images.rows, images.cols, images.color.size()});
  return bytes_.add(std::move(bytes));
}

EncodedImages ImageStore::encoded(size_t index) const {
  require(index < sizes_.size(), "ImageStore: no such image");
  const Size& size = sizes_[index];
  const std::vector<uint8_t> bytes = bytes_.load(index);
  const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(size.color_bytes);
  return {size.rows, size.cols, {bytes.begin(), middle}, {middle, bytes.end()}};
}

}  // namespace kinloop
