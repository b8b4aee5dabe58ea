#include "kinloop/base/mapped_file.hpp"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "kinloop/base/errors.hpp"

namespace kinloop {

MappedFile::MappedFile(const std::filesystem::path& path) {
  const auto fail = [&] {
    throw InputError(
        fmt::format("{}: cannot be read: {}", path.string(), std::generic_category().message(errno)));
  };
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) fail();
  struct stat status {};
  const bool regular = fstat(file, &status) == 0 && S_ISREG(status.st_mode);
  size_ = regular ? static_cast<size_t>(status.st_size) : 0;
  if (size_ > 0) begin_ = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
  close(file);
  if (!regular) throw InputError(fmt::format("{}: not a file", path.string()));
  if (begin_ == MAP_FAILED) fail();
}

MappedFile::~MappedFile() {
  if (begin_ != nullptr) munmap(begin_, size_);
}

}  // namespace kinloop
