#pragma once
// In: the files of a USD scene. Out: a USDZ package of them: a ZIP archive without compression, in which the
// bytes of every file begin at a multiple of 64, so that a reader can map them into memory
// (https://openusd.org/release/spec_usdz.html).

#include <span>
#include <string>

namespace kinloop {

struct PackagedFile {
  std::string name;
  std::string bytes;
};

/// The first file is the scene; it refers to the others by their names. Together they have less than 4 GiB,
/// else it throws std::logic_error.
std::string usdz_bytes(std::span<const PackagedFile> files);

}  // namespace kinloop
