#include <algorithm>
#include <cstdint>
#include <cstring>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfTileDescription.h>
#include <fmt/format.h>

#include "drivers/images/depth_files/depth_file.hpp"
#include "drivers/images/depth_files/depth_formats.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/text/lower_case.hpp"

namespace kinloop {
namespace {

using namespace std::string_view_literals;

constexpr int kMostChannels = 64;
constexpr auto kExrMagic = "\x76\x2f\x31\x01"sv;

/// The bytes of a file as OpenEXR reads them.
class ExrBytes : public Imf::IStream {
 public:
  explicit ExrBytes(std::string_view bytes) : IStream("EXR"), bytes_(bytes) {}

  bool read(char* to, int count) override {
    const auto size = static_cast<size_t>(count);
    if (count < 0 || at_ > bytes_.size() || size > bytes_.size() - at_) throw std::runtime_error("truncated");
    std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
    return at_ < bytes_.size();
  }
  uint64_t tellg() override { return at_; }
  void seekg(uint64_t position) override { at_ = position; }

 private:
  std::string_view bytes_;
  uint64_t at_ = 0;
};

/// Throws unless a list of channels ends where it says: OpenEXR reads on until it finds an end, and takes
/// what follows for something else.
void require_whole_channels(std::string_view list) {
  constexpr size_t kChannelBytes = 16;  // after the name: its type, sampling and reserved bytes
  while (!list.starts_with('\0')) {
    const size_t size = list.find('\0') + 1 + kChannelBytes;
    if (list.find('\0') == std::string_view::npos || size > list.size())
      throw std::runtime_error("channels without an end");
    list.remove_prefix(size);
  }
  if (list.size() != 1) throw std::runtime_error("bytes after the channels");
}

/// Throws unless all attributes of the headers lie within the file: OpenEXR allocates as much as an attribute
/// asks for before it reads that.
void require_whole_headers(std::string_view bytes) {
  constexpr size_t kMagicBytes = 4;
  constexpr uint32_t kSeveralParts = 0x1000;
  bytes.remove_prefix(kMagicBytes);
  const auto take = [&](size_t size) {
    if (size > bytes.size()) throw std::runtime_error("truncated");
    const std::string_view taken = bytes.substr(0, size);
    bytes.remove_prefix(size);
    return taken;
  };
  const auto take_number = [&] {
    uint32_t number = 0;
    std::memcpy(&number, take(sizeof number).data(), sizeof number);
    return number;
  };
  const auto take_text = [&] {
    const std::string_view text = take(std::min(bytes.find('\0'), bytes.size()));
    take(1);
    return text;
  };
  const bool several_parts = (take_number() & kSeveralParts) != 0;
  do {
    while (!bytes.starts_with('\0')) {
      take_text();  // name
      const std::string_view type = take_text(), value = take(take_number());
      if (type == "chlist") require_whole_channels(value);
    }
    take(1);  // the end of a header
  } while (several_parts && !bytes.starts_with('\0'));
}

/// How well a channel's name says that it is depth; less is better.
int exr_rank(const std::string& name) {
  const std::string small = lower_case(name.substr(name.find_last_of('.') + 1));
  if (small == "z") return 0;
  if (lower_case(name).find("depth") != std::string::npos) return 1;
  return small == "r" || small == "y" || small == "v" ? 2 : 3;
}

cv::Size checked_box_size(const Imath::Box2i& box) {
  const int64_t width = int64_t{box.max.x} - box.min.x + 1, height = int64_t{box.max.y} - box.min.y + 1;
  if (width <= 0 || height <= 0) throw InputError("the EXR header is damaged: its image is empty");
  return checked_depth_size(static_cast<uint64_t>(width), static_cast<uint64_t>(height));
}

/// Where depth is in a file, and its size there.
struct ExrDepth {
  int part = 0;
  std::string channel;
  cv::Size size;
};

/// Throws before OpenEXR allocates: all channels of a tile, and a row of tiles of the image.
void check_memory(const Imf::Header& header, cv::Size size) {
  const Imf::ChannelList& channels = header.channels();
  int count = 0;
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) ++count;
  if (count > kMostChannels)
    throw InputError(fmt::format("the EXR file has {} channels, more than {}", count, kMostChannels));
  if (!header.hasTileDescription()) return;
  const Imf::TileDescription& tile = header.tileDescription();
  static_cast<void>(checked_depth_size(tile.xSize, tile.ySize));
  static_cast<void>(checked_depth_size(static_cast<uint64_t>(size.width), tile.ySize));
}

ExrDepth exr_depth(const Imf::MultiPartInputFile& file) {
  std::optional<ExrDepth> best;
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Header& header = file.header(part);
    if (header.hasType() && Imf::isDeepData(header.type())) continue;
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
      const bool subsampled = channel.channel().xSampling != 1 || channel.channel().ySampling != 1;
      if (subsampled || (best && exr_rank(best->channel) <= exr_rank(channel.name()))) continue;
      best = ExrDepth{part, channel.name(), {}};
    }
  }
  if (!best) throw InputError("the EXR file has no channel that could be depth");
  const Imf::Header& header = file.header(best->part);
  best->size = checked_box_size(header.dataWindow());
  check_memory(header, best->size);
  return *best;
}

/// Calls `use(file)` without threads of OpenEXR. Its errors become InputError: they name a stream, no remedy.
template <class Use>
auto read_exr(std::string_view bytes, const Use& use) {
  try {
    require_whole_headers(bytes);
    ExrBytes stream(bytes);
    const bool repair = false;
    Imf::MultiPartInputFile file(stream, 0, repair);
    return use(file);
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    throw InputError("the EXR file is damaged or truncated; copy it again");
  }
}

}  // namespace

bool is_exr(std::string_view bytes) {
  return bytes.starts_with(kExrMagic);
}

cv::Size exr_size(std::string_view bytes) {
  return read_exr(bytes, [](Imf::MultiPartInputFile& file) { return exr_depth(file).size; });
}

cv::Mat decode_exr(std::string_view bytes) {
  return read_exr(bytes, [](Imf::MultiPartInputFile& file) {
    const ExrDepth depth = exr_depth(file);
    const Imath::Box2i window = file.header(depth.part).dataWindow();
    cv::Mat image(depth.size, CV_32FC1, cv::Scalar(0));
    Imf::FrameBuffer buffer;
    buffer.insert(depth.channel,
                  Imf::Slice::Make(Imf::FLOAT, image.data, window, image.elemSize(), image.step));
    Imf::InputPart part(file, depth.part);
    part.setFrameBuffer(buffer);
    part.readPixels(window.min.y, window.max.y);
    return image;
  });
}

}  // namespace kinloop
