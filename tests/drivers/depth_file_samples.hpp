#pragma once
// Depth images in the formats of numbers, written by the tests, and some by the libraries of the formats.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <ImfCompression.h>
#include <opencv2/core/mat.hpp>

namespace kinloop::test {

/// A 32FC1 image as OpenEXR with one channel Z of floats, compressed by ZIP.
std::string exr(const cv::Mat& depth);

/// A 32FC1 image as OpenEXR writes it, with one channel Y of half floats.
std::string exr_of_halves(const cv::Mat& depth, Imf::Compression compression);

/// An array of NumPy of the type of the image: 16UC1, 16SC1, 32SC1, 32FC1 or 64FC1.
std::string numpy(const cv::Mat& image);

/// A zip file of these arrays, deflated or stored, as numpy.savez_compressed and numpy.savez write it.
std::string numpy_archive(const std::vector<std::pair<std::string, std::string>>& arrays, bool deflated);

/// The image as cv::FileStorage writes it.
std::string opencv_yaml(const cv::Mat& image);

/// The image as cv::imencode writes it, with a compression by its number in TIFF.
std::string tiff(const cv::Mat& image, int compression);

/// How libtiff writes a file.
struct TiffLayout {
  uint16_t compression = 1, predictor = 1;
  int tile_px = 0;                             ///< 0: strips
  const char* mode = "w";                      ///< "wb" is big-endian, "w8" BigTIFF
  std::vector<uint32_t> kinds_of_pages = {0};  ///< the NewSubfileType of each page; all have the same pixels
};

/// The image, of 16UC1, 16SC1, 32SC1, 32FC1 or 64FC1, as libtiff writes it.
std::string tiff_by_libtiff(const cv::Mat& image, const TiffLayout& layout);

/// 16-bit PGM, which is big-endian.
std::string pgm(const cv::Mat& image);

/// 8 x 6 pixels of half floats, 0.5 + 0.25 x + y with 0 at (0, 0), as OpenEXR 3.1 wrote them.
struct ExrSample {
  const char* compression;  ///< and what else is special
  std::string bytes;
};
const std::vector<ExrSample>& exr_samples();

/// A depth format of the tables in docs/recordings.md: the ending of its files, and how depth is written to
/// it.
struct DepthFormat {
  const char* name;
  const char* ending;
  std::string (*write)(const cv::Mat& depth_mm);  ///< 16UC1 in millimetres
  bool writes_numbers = true;                     ///< see drivers/images/depth_files
};
const std::vector<DepthFormat>& depth_formats();

}  // namespace kinloop::test
