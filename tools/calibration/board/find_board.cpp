#include "tools/calibration/board/find_board.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/text/lower_case.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "tools/calibration/board/charuco.hpp"

namespace kinloop {
namespace {

cv::Mat single_channel(const cv::Mat& image) {
  cv::Mat single = image;
  if (image.channels() == 3) cv::cvtColor(image, single, cv::COLOR_BGR2GRAY);
  if (image.channels() == 4) cv::cvtColor(image, single, cv::COLOR_BGRA2GRAY);
  return single;
}

cv::Mat visible_infrared(const cv::Mat& infrared) {
  constexpr double kDarkShare = 0.01, kBrightShare = 0.99;
  const std::vector<uint16_t> values(infrared.begin<uint16_t>(), infrared.end<uint16_t>());
  const double dark = quantile(values, kDarkShare);
  const double bright = std::max<double>(quantile(values, kBrightShare), dark + 1);
  cv::Mat share, gray;
  infrared.convertTo(share, CV_32FC1, 1 / (bright - dark), -dark / (bright - dark));
  cv::sqrt(cv::max(share, 0), share);
  share.convertTo(gray, CV_8UC1, 255);
  return gray;
}

/// Factor by which small images are enlarged before detection, which needs squares of some ten pixels.
int enlargement(const cv::Mat& gray) {
  constexpr int kSmallWidth = 800;
  return gray.cols < kSmallWidth ? 2 : 1;
}

/// The shortest distance between neighbouring corners, px, which bounds the refinement window.
double shortest_side_px(const DetectedCorners& corners, const Board& board) {
  double shortest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < corners.corner_ids.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      const int a = corners.corner_ids[i], b = corners.corner_ids[j];
      const int steps =
          std::abs(a / board.columns - b / board.columns) + std::abs(a % board.columns - b % board.columns);
      if (steps == 1) shortest = std::min(shortest, cv::norm(corners.pixels[i] - corners.pixels[j]));
    }
  }
  return shortest;
}

/// Fraction of a square's side around a corner without markers, which lie in the white squares.
double free_share(const Board& board) {
  constexpr double kReach = 0.4, kInsideRim = 0.9;
  if (!board.has_markers()) return kReach;
  return std::min(kReach, kInsideRim * (1 - board.marker_m / board.square_m) / 2);
}

/// Refines corners to subpixel accuracy: all intensity gradients around are perpendicular to the direction of
/// the corner (Foerstner and Guelch 1987).
void refine(DetectedCorners& corners, const cv::Mat& gray, const Board& board) {
  constexpr double kMinValue = 2, kMaxCount = 11;  // px
  constexpr int kIterations = 100;
  constexpr double kConverged = 1e-3;  // px
  const int half = static_cast<int>(
      std::clamp(free_share(board) * shortest_side_px(corners, board), kMinValue, kMaxCount));
  cv::cornerSubPix(gray, corners.pixels, {half, half}, {-1, -1},
                   {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, kIterations, kConverged});
}

/// Local contrast stretching, which reveals a board through a reflection.
cv::Mat locally_stretched(const cv::Mat& gray) {
  constexpr double kMaxStretch = 4;
  constexpr int kParts = 8;  // per side
  cv::Mat stretched;
  cv::createCLAHE(kMaxStretch, {kParts, kParts})->apply(gray, stretched);
  return stretched;
}

/// All corners of a chessboard to about a pixel, or none.
DetectedCorners find_chessboard(const cv::Mat& gray, const Board& board) {
  DetectedCorners corners;
  if (!cv::findChessboardCorners(gray, {board.columns, board.rows}, corners.pixels)) return {};
  corners.corner_ids.resize(corners.pixels.size());
  std::iota(corners.corner_ids.begin(), corners.corner_ids.end(), 0);
  return corners;
}

/// Detects in `gray`, which is enhanced for visibility, and refines in `light`, which is linear in light: a
/// nonlinear curve would shift edges that are a pixel wide.
DetectedCorners corners_in(const cv::Mat& gray, const cv::Mat& light, const Board& board) {
  const auto find = board.has_markers() ? find_charuco : find_chessboard;
  DetectedCorners corners = find(gray, board);
  if (corners.corner_ids.empty()) corners = find(locally_stretched(gray), board);
  if (!corners.corner_ids.empty()) refine(corners, light, board);
  return corners;
}

bool is_image(const std::filesystem::path& path) {
  const std::string extension = lower_case(path.extension().string());
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

void require_one_size(const std::vector<BoardView>& views) {
  for (const BoardView& view : views) {
    const BoardView& first = views.front();
    if (view.width == first.width && view.height == first.height) continue;
    throw InputError(
        fmt::format("{}: {} x {} pixels, but {} has {} x {}; all stills must come from one camera in "
                    "one mode",
                    view.name, view.width, view.height, first.name, first.width, first.height));
  }
}

void require_size(const std::vector<std::filesystem::path>& stills, const Board& board, int threads) {
  const auto other = detect_other_board_size(stills, board, threads);
  if (!other) return;
  const std::string folder = stills.front().parent_path().string();
  throw InputError(fmt::format(
      "no {}x{} board in {}; it looks like {}x{}: use --board {}x{} (inner corners, where four squares "
      "meet)",
      board.columns, board.rows, folder, other->shorter, other->longer, other->shorter, other->longer));
}

}  // namespace

cv::Mat to_gray_8bit(const cv::Mat& image) {
  const cv::Mat single = single_channel(image);
  return single.depth() == CV_16U ? visible_infrared(single) : single;
}

std::optional<BoardView> find_board(const cv::Mat& image, const Board& board) {
  cv::Mat gray = to_gray_8bit(image), light;
  (image.depth() == CV_16U ? single_channel(image) : gray).convertTo(light, CV_32FC1);
  const int times = enlargement(gray);
  if (times > 1) {
    cv::resize(gray, gray, {}, times, times, cv::INTER_CUBIC);
    cv::resize(light, light, {}, times, times, cv::INTER_CUBIC);
  }
  const auto corners = corners_in(gray, light, board);
  if (corners.corner_ids.empty()) return std::nullopt;
  BoardView view;
  view.width = image.cols;
  view.height = image.rows;
  const auto corners_m = board.corners_m();
  // Pixel centres are integers: the enlarged image begins half a pixel further out than the small one.
  const double shift = 0.5 - 0.5 / times;
  for (size_t i = 0; i < corners.corner_ids.size(); ++i) {
    view.board_m.push_back(corners_m[static_cast<size_t>(corners.corner_ids[i])]);
    const cv::Point2d pixel = corners.pixels[i];
    view.pixels.emplace_back(pixel.x / times - shift, pixel.y / times - shift);
  }
  return view;
}

std::vector<std::filesystem::path> list_stills(const std::filesystem::path& folder,
                                               const std::string& ending) {
  require_folder(folder);
  std::vector<std::filesystem::path> stills;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (is_image(entry.path()) && entry.path().filename().string().ends_with(ending))
      stills.push_back(entry.path());
  }
  std::sort(stills.begin(), stills.end());
  if (stills.empty()) {
    throw InputError(fmt::format("{}: no PNG or JPEG images{}", folder.string(),
                                 ending.empty() ? "" : fmt::format(" whose names end with {}", ending)));
  }
  return stills;
}

cv::Mat read_still(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  if (const auto damage = image_damage(bytes); !damage.empty()) {
    throw InputError(fmt::format("{}: {}", path.string(), damage));
  }
  cv::Mat image = decode_image(bytes);
  if (image.empty()) {
    throw InputError(fmt::format("{}: cannot be decoded as an image of 8 or 16 bits", path.string()));
  }
  return image;
}

BoardSearch find_boards(const std::vector<std::filesystem::path>& stills, const Board& board, int threads,
                        const Progress& progress) {
  // Searching for an absent board takes seconds per image.
  report(progress, "looking for boards", 0, stills.size());
  require_size(stills, board, threads);
  constexpr size_t kStillsPerThread = 4;  // between progress reports
  const size_t batch = kStillsPerThread * static_cast<size_t>(std::max(threads, 1));
  std::vector<std::optional<BoardView>> found(stills.size());
  for (size_t first = 0; first < stills.size(); first += batch) {
    const size_t count = std::min(batch, stills.size() - first);
    parallel_for(count, threads, [&](size_t begin, size_t end) {
      for (size_t i = first + begin; i < first + end; ++i)
        found[i] = find_board(read_still(stills[i]), board);
    });
    if (!report(progress, "looking for boards", first + count, stills.size())) break;
  }
  BoardSearch search;
  for (size_t i = 0; i < stills.size(); ++i) {
    const std::string name = stills[i].filename().string();
    if (!found[i]) {
      search.without_board.push_back(name);
      continue;
    }
    found[i]->name = name;
    search.views.push_back(std::move(*found[i]));
  }
  if (search.views.empty()) {
    throw InputError(fmt::format(
        "{}: {} not found in any of {} images; count the corners where four squares meet (the squares of a "
        "ChArUco board), and show the whole board with a white border",
        stills.front().parent_path().string(), to_text(board), stills.size()));
  }
  require_one_size(search.views);
  return search;
}

}  // namespace kinloop
