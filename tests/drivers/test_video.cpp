#include "tests/drivers/test_video.hpp"

#include <memory>
#include <stdexcept>

#ifdef KINLOOP_WITH_VIDEO

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

namespace kinloop::test {
namespace {

void check(bool good) {
  if (!good) throw std::runtime_error("cannot write a test video");
}

/// Encodes to a QuickTime file, whatever its name; readers go by the content.
class VideoWriter {
 public:
  VideoWriter(const std::filesystem::path& file, AVCodecID id, AVPixelFormat pixels, cv::Size size,
              int b_frames) {
    check(avformat_alloc_output_context2(&format_, nullptr, "mov", file.c_str()) >= 0);
    const AVCodec* codec = avcodec_find_encoder(id);
    check(codec != nullptr);
    codec_ = avcodec_alloc_context3(codec);
    codec_->width = size.width;
    codec_->height = size.height;
    codec_->pix_fmt = pixels;
    codec_->time_base = {1, 600};
    codec_->max_b_frames = b_frames;
    codec_->thread_count = 1;
    codec_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    check(avcodec_open2(codec_, codec, nullptr) >= 0);
    stream_ = avformat_new_stream(format_, nullptr);
    stream_->time_base = codec_->time_base;
    check(avcodec_parameters_from_context(stream_->codecpar, codec_) >= 0);
    check(avio_open(&format_->pb, file.c_str(), AVIO_FLAG_WRITE) >= 0);
    check(avformat_write_header(format_, nullptr) >= 0);
  }
  ~VideoWriter() {
    avcodec_free_context(&codec_);
    avio_closep(&format_->pb);
    avformat_free_context(format_);
  }
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  void add(const cv::Mat& image, int64_t time) {
    AVFrame* frame = av_frame_alloc();
    frame->format = codec_->pix_fmt;
    frame->width = image.cols;
    frame->height = image.rows;
    frame->pts = time;
    check(av_frame_get_buffer(frame, 0) >= 0);
    SwsContext* scaler = sws_getContext(image.cols, image.rows, AV_PIX_FMT_BGR24, image.cols, image.rows,
                                        codec_->pix_fmt, SWS_POINT, nullptr, nullptr, nullptr);
    const uint8_t* rows[] = {image.data};
    const int steps[] = {static_cast<int>(image.step)};
    sws_scale(scaler, rows, steps, 0, image.rows, frame->data, frame->linesize);
    sws_freeContext(scaler);
    send(frame);
    av_frame_free(&frame);
  }

  void finish() {
    send(nullptr);
    check(av_write_trailer(format_) >= 0);
  }

 private:
  void send(const AVFrame* frame) {
    check(avcodec_send_frame(codec_, frame) >= 0);
    AVPacket* packet = av_packet_alloc();
    while (avcodec_receive_packet(codec_, packet) >= 0) {
      packet->stream_index = stream_->index;
      av_packet_rescale_ts(packet, codec_->time_base, stream_->time_base);
      check(av_interleaved_write_frame(format_, packet) >= 0);
    }
    av_packet_free(&packet);
  }

  AVFormatContext* format_ = nullptr;
  AVCodecContext* codec_ = nullptr;
  AVStream* stream_ = nullptr;
};

}  // namespace

void write_lossless_video(const std::filesystem::path& file, const std::vector<cv::Mat>& images) {
  VideoWriter writer(file, AV_CODEC_ID_PNG, AV_PIX_FMT_RGB24, images.front().size(), 0);
  for (size_t i = 0; i < images.size(); ++i) writer.add(images[i], static_cast<int64_t>(20 * i));
  writer.finish();
}

void write_video_with_b_frames(const std::filesystem::path& file, const std::vector<cv::Mat>& images) {
  VideoWriter writer(file, AV_CODEC_ID_MPEG4, AV_PIX_FMT_YUV420P, images.front().size(), 2);
  int64_t time = 0;
  for (size_t i = 0; i < images.size(); ++i) {
    writer.add(images[i], time);
    time += i % 3 == 0 ? 20 : 33;
  }
  writer.finish();
}

}  // namespace kinloop::test

#else

namespace kinloop::test {

void write_lossless_video(const std::filesystem::path&, const std::vector<cv::Mat>&) {}
void write_video_with_b_frames(const std::filesystem::path&, const std::vector<cv::Mat>&) {}

}  // namespace kinloop::test

#endif
