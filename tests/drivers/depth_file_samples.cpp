#include "tests/drivers/depth_file_samples.hpp"

#include <string_view>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <fmt/format.h>
#include <libdeflate.h>
#include <opencv2/imgcodecs.hpp>
#include <tiffio.h>

#include "kinloop/core/files/text_file.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop::test {
namespace {

template <class T>
void append_number(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

std::string raw_pixels(const cv::Mat& image) {
  return {reinterpret_cast<const char*>(image.data), image.total() * image.elemSize()};
}

using Compress = decltype(&libdeflate_zlib_compress);

std::string packed_by(Compress compress, const std::string& content) {
  constexpr int kLevel = 6;
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(kLevel);
  std::string bytes(libdeflate_zlib_compress_bound(compressor, content.size()), '\0');
  bytes.resize(compress(compressor, content.data(), content.size(), bytes.data(), bytes.size()));
  libdeflate_free_compressor(compressor);
  return bytes;
}

void append_attribute(std::string& header, const char* name, const char* type, const std::string& value) {
  header += std::string(name) + '\0' + type + '\0';
  append_number(header, static_cast<int32_t>(value.size()));
  header += value;
}

std::string exr_header(cv::Size size) {
  std::string header("\x76\x2f\x31\x01\x02\0\0\0", 8), channels("Z\0", 2), window;
  for (const int32_t number : {2, 0, 1, 1}) append_number(channels, number);  // float, not subsampled
  for (const int32_t number : {0, 0, size.width - 1, size.height - 1}) append_number(window, number);
  append_attribute(header, "channels", "chlist", channels + '\0');
  append_attribute(header, "compression", "compression", "\x03");
  append_attribute(header, "dataWindow", "box2i", window);
  append_attribute(header, "displayWindow", "box2i", window);
  append_attribute(header, "lineOrder", "lineOrder", std::string(1, '\0'));
  return header + '\0';
}

/// Even bytes first, then odd ones, as differences of successive bytes.
std::string exr_filtered(const std::string& pixels) {
  std::string halves, filtered;
  for (size_t i = 0; i < pixels.size(); i += 2) halves += pixels[i];
  for (size_t i = 1; i < pixels.size(); i += 2) halves += pixels[i];
  for (size_t i = 0; i < halves.size(); ++i)
    filtered += i == 0 ? halves[i] : static_cast<char>(halves[i] - halves[i - 1] + 128);
  return filtered;
}

cv::Mat as_metres(const cv::Mat& depth_mm) {
  cv::Mat depth_m;
  depth_mm.convertTo(depth_m, CV_32FC1, 1.0 / 1000);
  return depth_m;
}

cv::Mat as_floats(const cv::Mat& depth_mm) {
  cv::Mat floats;
  depth_mm.convertTo(floats, CV_32FC1);
  return floats;
}

std::string png_of_units(const cv::Mat& image) {
  std::vector<uint8_t> bytes;
  cv::imencode(".png", image, bytes);
  return {bytes.begin(), bytes.end()};
}

void set_tiff_tags(TIFF* file, const cv::Mat& image, const TiffLayout& layout, uint32_t kind) {
  constexpr int kBitsPerByte = 8, kRowsPerStrip = 16;
  const bool is_float = image.depth() == CV_32F || image.depth() == CV_64F;
  TIFFSetField(file, TIFFTAG_SUBFILETYPE, kind);
  TIFFSetField(file, TIFFTAG_IMAGEWIDTH, image.cols);
  TIFFSetField(file, TIFFTAG_IMAGELENGTH, image.rows);
  TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, static_cast<int>(image.elemSize()) * kBitsPerByte);
  TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(file, TIFFTAG_SAMPLEFORMAT,
               is_float                  ? SAMPLEFORMAT_IEEEFP
               : image.depth() == CV_16U ? SAMPLEFORMAT_UINT
                                         : SAMPLEFORMAT_INT);
  TIFFSetField(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  TIFFSetField(file, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(file, TIFFTAG_COMPRESSION, layout.compression);
  if (layout.predictor != 1) TIFFSetField(file, TIFFTAG_PREDICTOR, layout.predictor);
  if (layout.tile_px == 0) {
    TIFFSetField(file, TIFFTAG_ROWSPERSTRIP, kRowsPerStrip);
  } else {
    TIFFSetField(file, TIFFTAG_TILEWIDTH, layout.tile_px);
    TIFFSetField(file, TIFFTAG_TILELENGTH, layout.tile_px);
  }
}

void write_tiff_tiles(TIFF* file, const cv::Mat& image, int tile_px) {
  for (int y = 0; y < image.rows; y += tile_px) {
    for (int x = 0; x < image.cols; x += tile_px) {
      cv::Mat tile = cv::Mat::zeros(tile_px, tile_px, image.type());
      const cv::Rect inside = cv::Rect(x, y, tile_px, tile_px) & cv::Rect({0, 0}, image.size());
      image(inside).copyTo(tile(cv::Rect({0, 0}, inside.size())));
      TIFFWriteTile(file, tile.data, static_cast<uint32_t>(x), static_cast<uint32_t>(y), 0, 0);
    }
  }
}

const char* numpy_type(int type) {
  switch (type) {
    case CV_16UC1:
      return "<u2";
    case CV_16SC1:
      return "<i2";
    case CV_32SC1:
      return "<i4";
    case CV_64FC1:
      return "<f8";
    default:
      return "<f4";
  }
}

std::string from_hex(std::string_view hex) {
  constexpr int kHexadecimal = 16;
  std::string bytes;
  for (size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, kHexadecimal));
  return bytes;
}

/// A file of scan lines: what follows its header, as hexadecimal digits.
std::string scan_lines(char compression, std::string_view blocks) {
  std::string header = from_hex(
      "762f3101020000006368616e6e656c730063686c6973740013000000590001000000000000000100000001000000"
      "00636f6d7072657373696f6e00636f6d7072657373696f6e0001000000006461746157696e646f7700626f783269"
      "001000000000000000000000000700000005000000646973706c617957696e646f7700626f783269001000000000"
      "0000000000000007000000050000006c696e654f72646572006c696e654f72646572000100000000706978656c41"
      "7370656374526174696f00666c6f617400040000000000803f73637265656e57696e646f7743656e746572007632"
      "660008000000000000000000000073637265656e57696e646f77576964746800666c6f617400040000000000803f"
      "00");
  constexpr size_t kCompression = 75;
  header[kCompression] = compression;
  return header + from_hex(blocks);
}

}  // namespace

std::string exr(const cv::Mat& depth) {
  constexpr int kRows = 16;
  const std::string header = exr_header(depth.size());
  std::vector<std::string> blocks;
  for (int y = 0; y < depth.rows; y += kRows) {
    const std::string pixels = raw_pixels(depth.rowRange(y, std::min(y + kRows, depth.rows)).clone());
    std::string packed = packed_by(libdeflate_zlib_compress, exr_filtered(pixels));
    if (packed.size() >= pixels.size()) packed = pixels;
    std::string block;
    append_number(block, static_cast<int32_t>(y));
    append_number(block, static_cast<int32_t>(packed.size()));
    blocks.push_back(block + packed);
  }
  std::string table, content;
  for (const std::string& block : blocks) {
    append_number(table,
                  static_cast<uint64_t>(header.size() + sizeof(uint64_t) * blocks.size() + content.size()));
    content += block;
  }
  return header + table + content;
}

std::string exr_of_halves(const cv::Mat& depth, Imf::Compression compression) {
  std::vector<half> halves(depth.begin<float>(), depth.end<float>());
  Imf::Header header(depth.cols, depth.rows);
  header.compression() = compression;
  header.channels().insert("Y", Imf::Channel(Imf::HALF));
  Imf::FrameBuffer buffer;
  buffer.insert("Y", Imf::Slice::Make(Imf::HALF, halves.data(), header.dataWindow(), sizeof(half)));
  Imf::StdOSStream stream;
  {
    Imf::OutputFile file(stream, header, 0);  // finishes the stream at its end
    file.setFrameBuffer(buffer);
    file.writePixels(depth.rows);
  }
  return stream.str();
}

std::string numpy(const cv::Mat& image) {
  constexpr size_t kHeaderBytes = 118;
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}), }}",
                                   numpy_type(image.type()), image.rows, image.cols);
  header.resize(kHeaderBytes, ' ');
  std::string bytes("\x93NUMPY\x01\x00", 8);
  append_number(bytes, static_cast<uint16_t>(header.size()));
  return bytes + header + raw_pixels(image);
}

std::string numpy_archive(const std::vector<std::pair<std::string, std::string>>& arrays, bool deflated) {
  std::string files, directory;
  for (const auto& [name, bytes] : arrays) {
    const std::string packed = deflated ? packed_by(libdeflate_deflate_compress, bytes) : bytes;
    const auto offset = static_cast<uint32_t>(files.size());
    std::string common;  // flags, method, time, checksum, sizes, lengths of names
    for (const int number : {0, deflated ? 8 : 0, 0, 0, 0, 0})
      append_number(common, static_cast<uint16_t>(number));
    append_number(common, static_cast<uint32_t>(packed.size()));
    append_number(common, static_cast<uint32_t>(bytes.size()));
    append_number(common, static_cast<uint16_t>(name.size()));
    append_number(common, uint16_t{0});
    files += std::string("PK\x03\x04\x14\0", 6) + common + name + packed;
    directory += std::string("PK\x01\x02\x14\0\x14\0", 8) + common + std::string(10, '\0');
    append_number(directory, offset);
    directory += name;
  }
  std::string end("PK\x05\x06\0\0\0\0", 8);
  for (int i = 0; i < 2; ++i) append_number(end, static_cast<uint16_t>(arrays.size()));
  append_number(end, static_cast<uint32_t>(directory.size()));
  append_number(end, static_cast<uint32_t>(files.size()));
  return files + directory + end + std::string(2, '\0');
}

std::string opencv_yaml(const cv::Mat& image) {
  cv::FileStorage storage(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  storage << "depth" << image;
  return storage.releaseAndGetString();
}

std::string tiff(const cv::Mat& image, int compression) {
  std::vector<uint8_t> bytes;
  cv::imencode(".tiff", image, bytes, {cv::IMWRITE_TIFF_COMPRESSION, compression});
  return {bytes.begin(), bytes.end()};
}

std::string tiff_by_libtiff(const cv::Mat& image, const TiffLayout& layout) {
  const TempFolder folder;
  const auto path = folder.path() / "a.tiff";
  TIFF* file = TIFFOpen(path.c_str(), layout.mode);
  for (const uint32_t kind : layout.kinds_of_pages) {
    set_tiff_tags(file, image, layout, kind);
    if (layout.tile_px == 0) {
      cv::Mat rows = image.clone();  // the predictor changes them
      for (int y = 0; y < rows.rows; ++y) TIFFWriteScanline(file, rows.ptr(y), static_cast<uint32_t>(y));
    } else {
      write_tiff_tiles(file, image, layout.tile_px);
    }
    TIFFWriteDirectory(file);
  }
  TIFFClose(file);
  return read_file(path);
}

std::string pgm(const cv::Mat& image) {
  std::string bytes = fmt::format("P5\n# depth\n{} {}\n65535\n", image.cols, image.rows);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      bytes += static_cast<char>(image.at<uint16_t>(y, x) >> 8);
      bytes += static_cast<char>(image.at<uint16_t>(y, x) & 0xff);
    }
  }
  return bytes;
}

const std::vector<DepthFormat>& depth_formats() {
  constexpr int kNone = 1, kDeflate = 8;
  static const std::vector<DepthFormat> kFormats = {
      {"16-bit PNG", ".png", png_of_units, false},
      {"16-bit PGM", ".pgm", pgm, false},
      {"EXR in m", ".exr", [](const cv::Mat& mm) { return exr(as_metres(mm)); }},
      {"EXR in mm", ".exr", [](const cv::Mat& mm) { return exr(as_floats(mm)); }},
      {"16-bit TIFF", ".tif", [](const cv::Mat& mm) { return tiff(mm, kDeflate); }},
      {"TIFF of floats", ".tiff", [](const cv::Mat& mm) { return tiff(as_metres(mm), kNone); }},
      {"npy of uint16", ".npy", numpy},
      {"npy of float32", ".npy", [](const cv::Mat& mm) { return numpy(as_metres(mm)); }},
      {"npz", ".npz",
       [](const cv::Mat& mm) {
         return numpy_archive({{"depth.npy", numpy(as_metres(mm))}}, true);
       }},
      {"YAML of 16 bits", ".yml", opencv_yaml},
      {"YAML of floats", ".yml", [](const cv::Mat& mm) { return opencv_yaml(as_metres(mm)); }},
  };
  return kFormats;
}

const std::vector<ExrSample>& exr_samples() {
  static const std::vector<ExrSample> kSamples = {
      {"none",
       scan_lines(
           0,
           "45010000000000005d0100000000000075010000000000008d01000000000000a501000000000000bd0100000000"
           "000000000000100000000000003a003c003d003e003f004080400100000010000000003e003f0040804000418041"
           "00428042020000001000000000418041004280420043804300444044030000001000000000438043004440448044"
           "c0440045404504000000100000008044c044004540458045c0450046404605000000100000008045c04500464046"
           "8046c04600474047")},
      {"RLE",
       scan_lines(
           1,
           "45010000000000005a01000000000000710100000000000085010000000000009a01000000000000af0100000000"
           "0000000000000d000000ff000580fc0000ba820381ff80010000000f000000fd0080800400f83e81818081808180"
           "020000000c0000000600f7c08180818081808180030000000d000000020004c0fd8380810280fe8180040000000d"
           "000000ff8006c0fd8480810280fe8180050000000d000000ff8006c0fd8580810280fe8180")},
      {"ZIPS",
       scan_lines(
           2,
           "45010000000000005d0100000000000075010000000000008d01000000000000a501000000000000bd0100000000"
           "000000000000100000000000003a003c003d003e003f004080400100000010000000003e003f0040804000418041"
           "00428042020000001000000000418041004280420043804300444044030000001000000000438043004440448044"
           "c0440045404504000000100000008044c044004540458045c0450046404605000000100000008045c04500464046"
           "8046c04600474047")},
      {"ZIP",
       scan_lines(
           3,
           "1d010000000000000000000027000000785e636800030606104680030e408c0d38ec6a6a0482863a2006c17a3009"
           "a11bb0d000a3082cc8")},
      {"PIZ",
       scan_lines(
           4,
           "1d0100000000000000000000600000000000003a003c003d003e003f00408040003e003f00408040004180410042"
           "80420041804100428042004380430044404400438043004440448044c044004540458044c044004540458045c045"
           "004640468045c045004640468046c04600474047")},
      {"PXR24",
       scan_lines(
           5,
           "1d010000000000000000000027000000789c63b062620402062868b043628380230aafc1c119c17700011718d701"
           "025cd1f8005bcb0e8e")},
      {"DWAA",
       scan_lines(
           8,
           "1d0100000000000000000000600000000000003a003c003d003e003f00408040003e003f00408040004180410042"
           "80420041804100428042004380430044404400438043004440448044c044004540458044c044004540458045c045"
           "004640468045c045004640468046c04600474047")},
      {"B44",
       scan_lines(
           6,
           "1d010000000000000000000038000000804027f861f60861861820820820be00178c2ca24922a249229248a2c480"
           "130820924924924924924924c580130820924924924924924924")},
      {"ZIP_tiled",
       from_hex("762f3101020200006368616e6e656c730063686c6973740013000000590001000000000000000100000001000000"
                "00636f6d7072657373696f6e00636f6d7072657373696f6e0001000000036461746157696e646f7700626f783269"
                "001000000000000000000000000700000005000000646973706c617957696e646f7700626f783269001000000000"
                "0000000000000007000000050000006c696e654f72646572006c696e654f72646572000100000000706978656c41"
                "7370656374526174696f00666c6f617400040000000000803f73637265656e57696e646f7743656e746572007632"
                "660008000000000000000000000073637265656e57696e646f77576964746800666c6f617400040000000000803f"
                "74696c65730074696c656465736300090000000400000004000000000051010000000000007c01000000000000a8"
                "01000000000000cc010000000000000000000000000000000000000000000017000000785e63680003062838e0b0"
                "aba911081a601000a6240bc50100000000000000000000000000000018000000785e636868608082032050d7d8d8"
                "00830d400c00aa030cc600000000010000000000000000000000100000008044c044004540458045c04500464046"
                "01000000010000000000000000000000100000008045c045004640468046c04600474047")},
      {"ZIP_second_part",
       from_hex("762f3101021000006368616e6e656c730063686c6973740013000000520001000000000000000100000001000000"
                "006368756e6b436f756e7400696e74000400000001000000636f6d7072657373696f6e00636f6d7072657373696f"
                "6e0001000000036461746157696e646f7700626f7832690010000000000000000000000007000000050000006469"
                "73706c617957696e646f7700626f7832690010000000000000000000000007000000050000006c696e654f726465"
                "72006c696e654f726465720001000000006e616d6500737472696e670005000000636f6c6f72706978656c417370"
                "656374526174696f00666c6f617400040000000000803f73637265656e57696e646f7743656e7465720076326600"
                "08000000000000000000000073637265656e57696e646f77576964746800666c6f617400040000000000803f7479"
                "706500737472696e67000d0000007363616e6c696e65696d616765006368616e6e656c730063686c697374001300"
                "00005a0001000000000000000100000001000000006368756e6b436f756e7400696e74000400000001000000636f"
                "6d7072657373696f6e00636f6d7072657373696f6e0001000000036461746157696e646f7700626f783269001000"
                "000000000000000000000700000005000000646973706c617957696e646f7700626f783269001000000000000000"
                "0000000007000000050000006c696e654f72646572006c696e654f726465720001000000006e616d650073747269"
                "6e6700050000006465707468706978656c417370656374526174696f00666c6f617400040000000000803f736372"
                "65656e57696e646f7743656e746572007632660008000000000000000000000073637265656e57696e646f775769"
                "64746800666c6f617400040000000000803f7479706500737472696e67000d0000007363616e6c696e65696d6167"
                "650000c502000000000000e102000000000000000000000000000010000000785e6b68200d78a00b1000000e672f"
                "c9010000000000000027000000785e636800030606104680030e408c0d38ec6a6a0482863a2006c17a3009a11bb0"
                "d000a3082cc8")},
  };
  return kSamples;
}

}  // namespace kinloop::test
