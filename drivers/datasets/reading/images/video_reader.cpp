#include "drivers/datasets/reading/images/video_reader.hpp"

#include <vector>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/sensor/images/image_limits.hpp"

#ifdef KINLOOP_WITH_VIDEO

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/dict.h>
#include <libavutil/log.h>
#include <libswscale/swscale.h>
}

namespace kinloop {
namespace {

/// Each library frees through a pointer to the pointer.
template <auto kFree>
struct AvFree {
  template <class T>
  void operator()(T* object) const {
    kFree(&object);
  }
};

using FormatContext = std::unique_ptr<AVFormatContext, AvFree<avformat_close_input>>;
using CodecContext = std::unique_ptr<AVCodecContext, AvFree<avcodec_free_context>>;
using DecodedFrame = std::unique_ptr<AVFrame, AvFree<av_frame_free>>;
using Packet = std::unique_ptr<AVPacket, AvFree<av_packet_free>>;

/// The file may come from anywhere: other demuxers than that of MP4 open further files and addresses.
FormatContext open_video(const std::filesystem::path& file) {
  require_regular_file(file);
  AVFormatContext* format = nullptr;
  AVDictionary* options = nullptr;
  av_dict_set(&options, "protocol_whitelist", "file", 0);
  av_dict_set(&options, "format_whitelist", "mov,mp4,m4a,3gp,3g2,mj2", 0);
  const int result =
      avformat_open_input(&format, fmt::format("file:{}", file.string()).c_str(), nullptr, &options);
  av_dict_free(&options);
  if (result != 0)
    throw InputError(fmt::format("{}: not a video, or truncated; copy it again", file.string()));
  return FormatContext(format);
}

/// Decodes a little of each stream, no image above the limit of pixels.
bool find_stream_info(AVFormatContext& format) {
  std::vector<AVDictionary*> options(format.nb_streams);
  for (AVDictionary*& option : options)
    av_dict_set_int(&option, "max_pixels", static_cast<int64_t>(kMaxDecodedPixels), 0);
  const int result = avformat_find_stream_info(&format, options.data());
  for (AVDictionary*& option : options) av_dict_free(&option);
  return result >= 0;
}

}  // namespace

class VideoReader::Decoder {
 public:
  explicit Decoder(const std::filesystem::path& file)
      : file_(file),
        format_(open_video(file)),
        frame_(require_memory(av_frame_alloc())),
        packet_(require_memory(av_packet_alloc())) {
    const AVCodec* codec = nullptr;
    if (find_stream_info(*format_))
      stream_ = av_find_best_stream(format_.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
    if (stream_ < 0) throw InputError(fmt::format("{}: contains no video", file.string()));
    codec_.reset(require_memory(avcodec_alloc_context3(codec)));
    const AVCodecParameters* parameters = format_->streams[stream_]->codecpar;
    codec_->thread_count = 1;
    codec_->max_pixels = static_cast<int64_t>(kMaxDecodedPixels);
    const bool opened = avcodec_parameters_to_context(codec_.get(), parameters) >= 0 &&
                        avcodec_open2(codec_.get(), codec, nullptr) >= 0;
    if (!opened || codec_->width <= 0 || codec_->height <= 0)
      throw InputError(fmt::format("{}: its video codec cannot be decoded", file.string()));
  }
  ~Decoder() { sws_freeContext(scaler_); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  [[nodiscard]] cv::Size size() const { return {codec_->width, codec_->height}; }
  [[nodiscard]] size_t next_index() const { return next_index_; }

  /// Returns the next image; empty unless `wanted`, which saves its conversion.
  cv::Mat next(bool wanted) {
    receive();
    ++next_index_;
    return wanted ? bgr() : cv::Mat();
  }

 private:
  /// Decodes until a frame is complete: several packets may be needed where frames refer to later ones.
  void receive() {
    while (true) {
      const int received = avcodec_receive_frame(codec_.get(), frame_.get());
      if (received == 0) return;
      if (received != AVERROR(EAGAIN))
        throw InputError(fmt::format("{}: the video ends after {} frames", file_.string(), next_index_));
      send();
    }
  }

  void send() {
    while (av_read_frame(format_.get(), packet_.get()) >= 0) {
      const bool of_video = packet_->stream_index == stream_;
      if (of_video) static_cast<void>(avcodec_send_packet(codec_.get(), packet_.get()));
      av_packet_unref(packet_.get());
      if (of_video) return;
    }
    static_cast<void>(avcodec_send_packet(codec_.get(), nullptr));  // delivers what is still buffered
  }

  cv::Mat bgr() {
    cv::Mat image(frame_->height, frame_->width, CV_8UC3);
    scaler_ = sws_getCachedContext(
        scaler_, frame_->width, frame_->height, static_cast<AVPixelFormat>(frame_->format), frame_->width,
        frame_->height, AV_PIX_FMT_BGR24, SWS_BILINEAR | SWS_ACCURATE_RND, nullptr, nullptr, nullptr);
    if (scaler_ == nullptr)
      throw InputError(fmt::format("{}: frame {} has an unknown pixel format", file_.string(), next_index_));
    uint8_t* rows[] = {image.data, nullptr, nullptr, nullptr};
    const int steps[] = {static_cast<int>(image.step), 0, 0, 0};
    sws_scale(scaler_, frame_->data, frame_->linesize, 0, frame_->height, rows, steps);
    return image;
  }

  std::filesystem::path file_;
  FormatContext format_;
  DecodedFrame frame_;
  Packet packet_;
  CodecContext codec_;
  SwsContext* scaler_ = nullptr;
  int stream_ = -1;
  size_t next_index_ = 0;
};

bool video_available() {
  return true;
}

VideoReader::VideoReader(const std::filesystem::path& file) : file_(file) {
  std::error_code absent;
  if (!std::filesystem::exists(file, absent))
    throw InputError(fmt::format("{}: no such file; export the recording with its video", file.string()));
  av_log_set_level(AV_LOG_QUIET);  // damage is reported by exceptions
  decoder_ = std::make_unique<Decoder>(file);
}

VideoReader::~VideoReader() = default;

cv::Size VideoReader::size() const {
  return decoder_->size();
}

cv::Mat VideoReader::read(size_t index) {
  if (index < decoder_->next_index()) decoder_ = std::make_unique<Decoder>(file_);
  while (decoder_->next_index() < index) static_cast<void>(decoder_->next(false));
  return decoder_->next(true);
}

}  // namespace kinloop

#else

namespace kinloop {

class VideoReader::Decoder {};

bool video_available() {
  return false;
}

VideoReader::VideoReader(const std::filesystem::path& file) : file_(file) {
  throw InputError(fmt::format(
      "{}: this build reads no video; install libavformat-dev libavcodec-dev libswscale-dev and rebuild",
      file.string()));
}

VideoReader::~VideoReader() = default;

cv::Size VideoReader::size() const {
  return {};
}

cv::Mat VideoReader::read(size_t) {
  return {};
}

}  // namespace kinloop

#endif
