#include "tools/vocabulary_training/descriptors/descriptor_file.hpp"

#include <gmock/gmock.h>

#include "kinloop/core/files/text_file.hpp"
#include "tests/place/synthetic.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/vocabulary_training/descriptors/training_images.hpp"

namespace kinloop {
namespace {

using testing::HasSubstr;

std::filesystem::path written(const test::TempFolder& folder, const std::vector<cv::Mat>& images) {
  auto path = folder.path() / "a.kindesc";
  DescriptorFileWriter writer(path, DescriptorKind::kOrb);
  for (const auto& image : images) writer.append(image);
  writer.commit();
  return path;
}

TEST(DescriptorFile, GivesBackWhatWasWritten) {
  const test::TempFolder folder;
  auto images = test::clustered_images(3, 20, 10, 1);
  images.insert(images.begin() + 1, cv::Mat());
  DescriptorFile file(written(folder, images));
  EXPECT_EQ(file.kind(), DescriptorKind::kOrb);
  EXPECT_EQ(file.rows(), 60U);
  ASSERT_EQ(file.images(), images.size());
  for (size_t i = 0; i < images.size(); ++i) {
    ASSERT_EQ(file.descriptors_of_image(i).rows, images[i].rows);
    if (images[i].empty()) continue;
    EXPECT_EQ(cv::norm(file.descriptors_of_image(i), images[i], cv::NORM_HAMMING), 0);
  }
  EXPECT_THROW((void)file.descriptors_of_image(images.size()), std::logic_error);
}

TEST(DescriptorFile, IsTrainingInput) {
  const test::TempFolder folder;
  const auto images = test::clustered_images(5, 20, 10, 1);
  const TrainingInput input = list_training_input(std::vector{written(folder, images)});
  ASSERT_EQ(input.descriptor_files.size(), 1U);
  const TrainingSet expected = to_training_set(images);
  const TrainingSet read = read_training_set(input, {}).set;
  EXPECT_EQ(read.rows, expected.rows);
  EXPECT_EQ(read.image_of, expected.image_of);
  DescribeOptions other;
  other.kind = DescriptorKind::kSurfBinary;
  EXPECT_THAT(test::input_error([&] { read_training_set(input, other); }),
              testing::AllOf(HasSubstr("a.kindesc"), HasSubstr("ORB"), HasSubstr("SURF")));
}

TEST(DescriptorFile, AnythingElseIsAnErrorThatNamesIt) {
  const test::TempFolder folder;
  const std::string bytes = read_file(written(folder, test::clustered_images(3, 20, 10, 1)));
  const auto error_of = [&](const std::string& content) {
    const auto path = folder.write("b.kindesc", content);
    const std::string error = test::input_error([&] { DescriptorFile{path}; });
    EXPECT_THAT(error, HasSubstr("b.kindesc"));
    return error;
  };
  for (const size_t size : {size_t{0}, size_t{10}, size_t{31}, size_t{32}, bytes.size() - 1}) {
    error_of(bytes.substr(0, size));
  }
  EXPECT_THAT(error_of(bytes + "x"), HasSubstr("appended"));
  for (const size_t at : {0U, 8U, 12U, 16U, 23U, 24U, 31U}) {
    std::string altered = bytes;
    altered[at] = static_cast<char>(altered[at] ^ 0x55);
    error_of(altered);
  }
  std::string altered = bytes;
  altered.back() = 1;  // 2^24 more descriptors for one image
  EXPECT_THAT(error_of(altered), HasSubstr("its images"));
}

TEST(DescriptorFile, CutShortWhileItIsReadIsAnError) {
  const test::TempFolder folder;
  const auto path = written(folder, {cv::Mat(2000, kOrbBytes, CV_8UC1, cv::Scalar(1)),
                                     cv::Mat(1, kOrbBytes, CV_8UC1, cv::Scalar(2))});
  DescriptorFile file(path);
  std::filesystem::resize_file(path, 1000);
  EXPECT_THAT(test::input_error([&] { static_cast<void>(file.descriptors_of_image(0)); }),
              testing::HasSubstr("truncated"));
}

}  // namespace
}  // namespace kinloop
