#include "tools/calibration/board/charuco.hpp"

#include "kinloop/core/errors.hpp"

#ifdef KINLOOP_WITH_ARUCO

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/aruco/charuco.hpp>

namespace kinloop {
namespace {

struct NamedDictionary {
  const char* name;
  cv::aruco::PREDEFINED_DICTIONARY_NAME id;
};

constexpr NamedDictionary kDictionaries[] = {{"DICT_4X4_50", cv::aruco::DICT_4X4_50},
                                             {"DICT_4X4_100", cv::aruco::DICT_4X4_100},
                                             {"DICT_4X4_250", cv::aruco::DICT_4X4_250},
                                             {"DICT_4X4_1000", cv::aruco::DICT_4X4_1000},
                                             {"DICT_5X5_50", cv::aruco::DICT_5X5_50},
                                             {"DICT_5X5_100", cv::aruco::DICT_5X5_100},
                                             {"DICT_5X5_250", cv::aruco::DICT_5X5_250},
                                             {"DICT_5X5_1000", cv::aruco::DICT_5X5_1000},
                                             {"DICT_6X6_50", cv::aruco::DICT_6X6_50},
                                             {"DICT_6X6_100", cv::aruco::DICT_6X6_100},
                                             {"DICT_6X6_250", cv::aruco::DICT_6X6_250},
                                             {"DICT_6X6_1000", cv::aruco::DICT_6X6_1000},
                                             {"DICT_7X7_50", cv::aruco::DICT_7X7_50},
                                             {"DICT_7X7_100", cv::aruco::DICT_7X7_100},
                                             {"DICT_7X7_250", cv::aruco::DICT_7X7_250},
                                             {"DICT_7X7_1000", cv::aruco::DICT_7X7_1000},
                                             {"DICT_ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL}};

/// The dictionary of that name; null if unknown.
cv::Ptr<cv::aruco::Dictionary> dictionary_named(const std::string& name) {
  for (const auto& known : kDictionaries) {
    if (name == known.name) return cv::aruco::getPredefinedDictionary(known.id);
  }
  return nullptr;
}

cv::Ptr<cv::aruco::CharucoBoard> opencv_board(const Board& board) {
  return cv::aruco::CharucoBoard::create(
      board.columns + 1, board.rows + 1, static_cast<float>(board.square_m),
      static_cast<float>(board.marker_m), dictionary_named(board.dictionary));
}

/// Whether these corners determine a plane: enough of them, in more than one row and column.
bool fix_a_plane(const std::vector<int>& corner_ids, const Board& board) {
  constexpr size_t kMinCount = 6;
  std::set<int> rows, columns;
  for (const int place : corner_ids) {
    rows.insert(place / board.columns);
    columns.insert(place % board.columns);
  }
  return corner_ids.size() >= kMinCount && rows.size() > 1 && columns.size() > 1;
}

}  // namespace

bool charuco_available() {
  return true;
}

void require_charuco(const Board& board) {
  const auto dictionary = dictionary_named(board.dictionary);
  if (!dictionary) {
    std::vector<std::string> names;
    for (const auto& known : kDictionaries) names.emplace_back(known.name);
    throw UsageError(fmt::format("--board: unknown dictionary '{}'; expected one of {}", board.dictionary,
                                 fmt::join(names, ", ")));
  }
  const int markers = (board.columns + 1) * (board.rows + 1) / 2;
  if (markers > dictionary->bytesList.rows) {
    throw UsageError(fmt::format("--board: the board needs {} markers, but {} has only {}", markers,
                                 board.dictionary, dictionary->bytesList.rows));
  }
}

DetectedCorners find_charuco(const cv::Mat& gray, const Board& board) {
  const auto charuco = opencv_board(board);
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> ids;
  cv::aruco::detectMarkers(gray, charuco->dictionary, markers, ids);
  DetectedCorners corners;
  if (!ids.empty()) {
    cv::aruco::interpolateCornersCharuco(markers, ids, gray, charuco, corners.pixels, corners.corner_ids);
  }
  return fix_a_plane(corners.corner_ids, board) ? corners : DetectedCorners{};
}

}  // namespace kinloop

#else

namespace kinloop {

bool charuco_available() {
  return false;
}

void require_charuco(const Board&) {
  throw UsageError(
      "--board: ChArUco is not supported by this build; install libopencv-contrib-dev (OpenCV before 4.7) "
      "and "
      "rebuild, or use a plain chessboard");
}

DetectedCorners find_charuco(const cv::Mat&, const Board& board) {
  require_charuco(board);
  return {};
}

}  // namespace kinloop

#endif
