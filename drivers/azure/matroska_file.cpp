#include <fmt/format.h>

#include "drivers/azure/azure_recording.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"

#ifdef KINLOOP_WITH_VIDEO

#include <cmath>

extern "C" {
#include <libavcodec/codec_id.h>
#include <libavcodec/packet.h>
#include <libavformat/avformat.h>
#include <libavutil/dict.h>
#include <libavutil/log.h>
}

#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

struct CloseFormat {
  void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
};
struct FreePacket {
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};

std::string value_of(const AVStream& stream, const char* key) {
  const AVDictionaryEntry* entry = av_dict_get(stream.metadata, key, nullptr, 0);
  return entry == nullptr ? "" : printable(entry->value);
}

std::string fourcc_of(const AVCodecParameters& codec) {
  if (codec.codec_id == AV_CODEC_ID_MJPEG) return "MJPG";
  if (codec.codec_id == AV_CODEC_ID_PNG) return "png";
  std::string text;
  for (unsigned shift = 0; shift < 32; shift += 8)
    text += static_cast<char>(codec.codec_tag >> shift & 0xFFU);
  return printable(text);
}

}  // namespace

struct MatroskaFile::Implementation {
  std::unique_ptr<AVFormatContext, CloseFormat> format;
  std::unique_ptr<AVPacket, FreePacket> packet{require_memory(av_packet_alloc())};
  std::vector<MatroskaTrack> tracks;
};

MatroskaFile::MatroskaFile(const std::filesystem::path& path)
    : implementation_(std::make_unique<Implementation>()) {
  require_regular_file(path);
  av_log_set_level(AV_LOG_QUIET);  // what is wrong is reported by us
  const AVInputFormat* matroska = av_find_input_format("matroska");
  AVFormatContext* raw = require_memory(avformat_alloc_context());
  AVDictionary* options = nullptr;
  av_dict_set(&options, "protocol_whitelist", "file", 0);
  const int result =
      avformat_open_input(&raw, fmt::format("file:{}", path.string()).c_str(), matroska, &options);
  av_dict_free(&options);
  if (result < 0)
    throw InputError(
        fmt::format("{}: not a readable Matroska file; it may be truncated or damaged", path.string()));
  implementation_->format.reset(raw);
  for (unsigned i = 0; i < raw->nb_streams; ++i) {
    const AVStream& stream = *raw->streams[i];
    const AVCodecParameters& codec = *stream.codecpar;
    MatroskaTrack track{value_of(stream, "title"), fourcc_of(codec), codec.width, codec.height, 0};
    const double frames = av_q2d(stream.avg_frame_rate) * static_cast<double>(raw->duration) / AV_TIME_BASE;
    constexpr double kMaxFrames = 1e7;
    if (frames > 0 && frames < kMaxFrames) track.frames = static_cast<size_t>(std::lround(frames));
    implementation_->tracks.push_back(track);
  }
}

MatroskaFile::~MatroskaFile() = default;
MatroskaFile::MatroskaFile(MatroskaFile&&) noexcept = default;

const std::vector<MatroskaTrack>& MatroskaFile::tracks() const {
  return implementation_->tracks;
}

std::optional<std::string> MatroskaFile::attachment(const std::string& name) const {
  const AVFormatContext& format = *implementation_->format;
  for (unsigned i = 0; i < format.nb_streams; ++i) {
    const AVStream& stream = *format.streams[i];
    const AVCodecParameters& codec = *stream.codecpar;
    if (value_of(stream, "filename") != name || codec.extradata == nullptr) continue;
    return std::string(as_text({codec.extradata, static_cast<size_t>(codec.extradata_size)}));
  }
  return std::nullopt;
}

std::optional<MatroskaBlock> MatroskaFile::next() {
  AVPacket* packet = implementation_->packet.get();
  av_packet_unref(packet);
  if (av_read_frame(implementation_->format.get(), packet) < 0) return std::nullopt;
  const auto track = static_cast<size_t>(packet->stream_index);
  const AVRational base = implementation_->format->streams[track]->time_base;
  const int64_t stamp_ns = av_rescale_q(packet->pts, base, AVRational{1, static_cast<int>(kNsPerSecond)});
  return MatroskaBlock{track, stamp_ns, {packet->data, static_cast<size_t>(std::max(packet->size, 0))}};
}

}  // namespace kinloop

#else

namespace kinloop {

struct MatroskaFile::Implementation {};

MatroskaFile::MatroskaFile(const std::filesystem::path& path) {
  throw UsageError(
      fmt::format("{}: Matroska files are not supported by this build; install libavformat-dev "
                  "libavcodec-dev and rebuild",
                  path.string()));
}

MatroskaFile::~MatroskaFile() = default;
MatroskaFile::MatroskaFile(MatroskaFile&&) noexcept = default;

const std::vector<MatroskaTrack>& MatroskaFile::tracks() const {
  throw std::logic_error("MatroskaFile: none is open");
}

std::optional<std::string> MatroskaFile::attachment(const std::string&) const {
  return std::nullopt;
}

std::optional<MatroskaBlock> MatroskaFile::next() {
  return std::nullopt;
}

}  // namespace kinloop

#endif
