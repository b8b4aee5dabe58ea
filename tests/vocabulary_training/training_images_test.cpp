#include "tools/vocabulary_training/descriptors/training_images.hpp"

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include "kinloop/core/random.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

/// Squares of random intensity: corners at known positions.
std::string png_of_squares(int width, int height, uint64_t seed) {
  constexpr int kSquare_px = 16;
  Random random(seed);
  cv::Mat image(height, width, CV_8UC1);
  for (int y = 0; y < height; y += kSquare_px) {
    for (int x = 0; x < width; x += kSquare_px) {
      const cv::Rect square(x, y, std::min(kSquare_px, width - x), std::min(kSquare_px, height - y));
      image(square) = static_cast<double>(random.index(256));
    }
  }
  std::vector<uchar> bytes;
  cv::imencode(".png", image, bytes);
  return {bytes.begin(), bytes.end()};
}

struct Described {
  std::vector<cv::Mat> of_images;
  std::vector<fs::path> unreadable;
};

Described describe(const std::vector<fs::path>& paths, int threads, const Progress& progress = {}) {
  Described described;
  DescribeOptions description;
  description.threads = threads;
  describe_images(paths, description, progress,
                  [&](const fs::path& path, const std::optional<cv::Mat>& descriptors) {
                    if (descriptors) {
                      described.of_images.push_back(*descriptors);
                    } else {
                      described.unreadable.push_back(path);
                    }
                  });
  return described;
}

TEST(ListTrainingInput, FilesFoldersAndSequences) {
  const test::TempFolder folder;
  for (const char* name :
       {"photos/b.PNG", "photos/a.jpg", "photos/more/c.jpeg", "photos/notes.txt", "single.png"}) {
    folder.write(name, "");
  }
  folder.write("sequence/rgb.txt", "# stamp file\n1.0 rgb/2.png\n2.0 rgb/1.png\n");
  folder.write("sequence/depth/1.png", "");
  const auto& root = folder.path();
  EXPECT_THAT(
      list_training_input(std::vector<fs::path>{root / "single.png", root / "photos", root / "sequence"})
          .images,
      ElementsAre(root / "single.png", root / "photos/a.jpg", root / "photos/b.PNG",
                  root / "photos/more/c.jpeg", root / "sequence/rgb/2.png", root / "sequence/rgb/1.png"));
}

TEST(ListTrainingInput, ReportsMissingInputs) {
  const test::TempFolder folder;
  const auto error_of = [](const fs::path& path) {
    return test::input_error([&] { list_training_input(std::vector{path}); });
  };
  EXPECT_THAT(error_of(folder.path() / "nowhere"), HasSubstr("nowhere"));
  folder.write("empty/notes.txt", "");
  EXPECT_THAT(error_of(folder.path() / "empty"), HasSubstr("no image"));
  folder.write("bad/rgb.txt", "1.0\n");
  EXPECT_THAT(error_of(folder.path() / "bad"), HasSubstr("rgb.txt:1"));
}

TEST(DescribeImages, UnreadableOnesAreSkippedAndNamed) {
  const test::TempFolder folder;
  const std::string image = png_of_squares(320, 240, 1);
  const std::vector<fs::path> paths = {
      folder.write("good.png", image),
      folder.write("text.png", "this is no image"),
      folder.write("cut.png", image.substr(0, 20)),
      folder.write("empty.png", ""),
      folder.path() / "missing.png",
      folder.write("other.png", png_of_squares(320, 240, 2)),
  };
  const auto described = describe(paths, 2);
  ASSERT_EQ(described.of_images.size(), 2U);
  for (const auto& descriptors : described.of_images) {
    EXPECT_EQ(descriptors.type(), CV_8UC1);
    EXPECT_EQ(descriptors.cols, 32);
    EXPECT_GT(descriptors.rows, 20);
  }
  EXPECT_EQ(described.unreadable, std::vector(paths.begin() + 1, paths.begin() + 5));
}

TEST(DescribeImages, ImagesTooSmallForFeaturesHaveNone) {
  const test::TempFolder folder;
  std::vector<fs::path> paths;
  for (const int size : {1, 2, 7, 16, 32}) {
    paths.push_back(folder.write(std::to_string(size) + ".png", png_of_squares(size, size, 3)));
  }
  paths.push_back(folder.write("wide.png", png_of_squares(400, 3, 3)));
  const auto described = describe(paths, 1);
  ASSERT_EQ(described.of_images.size(), paths.size());
  EXPECT_TRUE(described.unreadable.empty());
  for (const auto& descriptors : described.of_images) EXPECT_EQ(descriptors.rows, 0);
}

TEST(DescribeImages, DoesNotDependOnTheNumberOfThreads) {
  const test::TempFolder folder;
  std::vector<fs::path> paths;
  for (uint64_t i = 0; i < 20; ++i) {
    paths.push_back(folder.write(std::to_string(i) + ".png", png_of_squares(200, 160, i)));
  }
  const auto one = describe(paths, 1).of_images;
  const auto three = describe(paths, 3).of_images;
  ASSERT_EQ(one.size(), three.size());
  for (size_t i = 0; i < one.size(); ++i) EXPECT_EQ(cv::norm(one[i], three[i], cv::NORM_HAMMING), 0) << i;
}

TEST(DescribeImages, StopsWhenAsked) {
  const test::TempFolder folder;
  const std::vector<fs::path> paths(40, folder.write("a.png", png_of_squares(64, 64, 1)));
  const auto described = describe(paths, 1, [](const ProgressReport& now) { return now.done == 0; });
  EXPECT_GT(described.of_images.size(), 0U);
  EXPECT_LT(described.of_images.size(), paths.size());
}

}  // namespace
}  // namespace kinloop
