#pragma once
// In: a deflated block whose size is known. Out: its bytes. A small block cannot expand to more than that.

#include <cstddef>
#include <string>
#include <string_view>

namespace kinloop {

/// Throws InputError unless `bytes` are a zlib stream of exactly `size` bytes.
std::string inflate_zlib(std::string_view bytes, size_t size);

/// The same of a deflate stream without the header of zlib.
std::string inflate_raw(std::string_view bytes, size_t size);

}  // namespace kinloop
