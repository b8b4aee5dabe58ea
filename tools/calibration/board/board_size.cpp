#include <algorithm>
#include <map>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "kinloop/core/threads/parallel_for.hpp"
#include "tools/calibration/board/find_board.hpp"

namespace kinloop {
namespace {

BoardSize size_of(int columns, int rows) {
  return {std::min(columns, rows), std::max(columns, rows)};
}

/// Scales every image to about one size, since search time grows with the number of pixels.
cv::Mat at_search_size(const cv::Mat& gray) {
  constexpr double kWidthPx = 960, kMaxEnlarged = 2;
  const double scale = std::min(kWidthPx / gray.cols, kMaxEnlarged);
  cv::Mat resized;
  cv::resize(gray, resized, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  return resized;
}

/// Grows a board from `least` x `least` corners as far as possible (Duda and Frese 2018).
std::optional<BoardSize> grown_from(const cv::Mat& gray, int least) {
  std::vector<cv::Point2f> corners;
  cv::Mat layout;  // one element per corner
  const bool found = cv::findChessboardCornersSB(gray, {least, least}, corners,
                                                 cv::CALIB_CB_LARGER | cv::CALIB_CB_NORMALIZE_IMAGE, layout);
  return found ? std::optional(size_of(layout.cols, layout.rows)) : std::nullopt;
}

bool shows(const cv::Mat& gray, const BoardSize& size) {
  std::vector<cv::Point2f> corners;
  return cv::findChessboardCorners(gray, {size.shorter, size.longer}, corners);
}

/// Same as `detect_board_size` for an image already scaled for the search.
std::optional<BoardSize> seen_size(const cv::Mat& image) {
  // Growing from 3 x 3 may stop early, e.g. at 3 x 7 corners of 5 x 7.
  constexpr int kReliableSize = 4, kMinValue = 3;
  const auto found = grown_from(image, kReliableSize);
  return found ? found : grown_from(image, kMinValue);
}

std::vector<cv::Mat> some_of(const std::vector<std::filesystem::path>& stills) {
  constexpr size_t kMaxCount = 4;
  const size_t count = std::min(kMaxCount, stills.size());
  std::vector<cv::Mat> images;
  for (size_t i = 0; i < count; ++i)
    images.push_back(at_search_size(to_gray_8bit(read_still(stills[i * stills.size() / count]))));
  return images;
}

}  // namespace

std::optional<BoardSize> detect_board_size(const cv::Mat& gray) {
  return seen_size(at_search_size(gray));
}

std::optional<BoardSize> detect_other_board_size(const std::vector<std::filesystem::path>& stills,
                                                 const Board& board, int threads) {
  if (board.has_markers()) return std::nullopt;
  const BoardSize wanted = size_of(board.columns, board.rows);
  const auto images = some_of(stills);
  std::vector<std::optional<BoardSize>> sizes(images.size());
  parallel_for(images.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) sizes[i] = seen_size(images[i]);
  });
  std::map<BoardSize, std::vector<size_t>> images_of;
  for (size_t i = 0; i < sizes.size(); ++i) {
    if (sizes[i]) images_of[*sizes[i]].push_back(i);
  }
  if (images_of.empty() || images_of.contains(wanted)) return std::nullopt;
  const auto most = std::max_element(images_of.begin(), images_of.end(), [](const auto& a, const auto& b) {
    return a.second.size() < b.second.size();
  });
  const auto& [size, agreeing] = *most;
  if (agreeing.size() < std::min<size_t>(2, images.size())) return std::nullopt;
  // The detector used for calibration must confirm the size.
  const cv::Mat& image = images[agreeing.front()];
  const bool part_of_it = wanted.shorter <= size.shorter && wanted.longer <= size.longer;
  if (!shows(image, size) || (!part_of_it && shows(image, wanted))) return std::nullopt;
  return size;
}

}  // namespace kinloop
