#include "tools/floor_plan/drawing/drawing.hpp"

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include "tools/floor_plan/drawing/latin1.hpp"

namespace kinloop {
namespace {

using testing::HasSubstr;

Drawing small_drawing() {
  Drawing drawing;
  drawing.size_mm = {50.8, 25.4};
  drawing.title = "a (b)";
  drawing.area({{0, 0}, {25.4, 0}, {25.4, 25.4}, {0, 25.4}}, {200, 100, 50});
  drawing.line({{30, 5}, {45, 5}}, {0, 0, 0}, 0.25, 2);
  drawing.text({38, 20}, "9.50 m²", 4);
  return drawing;
}

TEST(Drawing, SvgHasTheSizeOfTheSheetAndEscapesText) {
  Drawing drawing = small_drawing();
  drawing.text({10, 20}, "a < b & c", 3);
  const std::string svg = svg_of(drawing);
  EXPECT_THAT(svg, HasSubstr("width=\"50.80mm\" height=\"25.40mm\""));
  EXPECT_THAT(svg, HasSubstr(">a &lt; b &amp; c</text>"));
  EXPECT_THAT(svg, HasSubstr("fill=\"#c86432\""));
  EXPECT_THAT(svg, HasSubstr("stroke-dasharray=\"2.00\""));
}

TEST(Drawing, PdfHasATableOfItsObjects) {
  const std::string pdf = pdf_of(small_drawing());
  EXPECT_THAT(pdf, testing::StartsWith("%PDF-1.4\n"));
  EXPECT_THAT(pdf, HasSubstr("/MediaBox [0 0 144.000 72.000]"));
  EXPECT_THAT(pdf, HasSubstr("(9.50 m\xB2) Tj"));
  EXPECT_THAT(pdf, HasSubstr("/Title (a \\(b\\))"));
  const size_t table = pdf.find("xref\n");
  ASSERT_NE(table, std::string::npos);
  EXPECT_THAT(pdf, HasSubstr("startxref\n" + std::to_string(table) + "\n%%EOF"));
  for (size_t object = 1; object <= 6; ++object) {
    const std::string offset = pdf.substr(table + std::string("xref\n0 7\n").size() + 20 * object, 10);
    EXPECT_EQ(pdf.find(std::to_string(object) + " 0 obj\n"), std::stoul(offset)) << object;
  }
  const size_t begin = pdf.find("stream\n") + 7, end = pdf.find("endstream");
  EXPECT_THAT(pdf, HasSubstr("/Length " + std::to_string(end - begin) + " "));
}

TEST(Drawing, PngHasTheColoursWhereTheyBelong) {
  const std::string png = png_of(small_drawing(), 100);
  const cv::Mat image = cv::imdecode(std::vector<uint8_t>(png.begin(), png.end()), cv::IMREAD_COLOR);
  ASSERT_EQ(image.size(), cv::Size(200, 100));
  EXPECT_EQ(image.at<cv::Vec3b>(50, 50), cv::Vec3b(50, 100, 200));
  EXPECT_EQ(image.at<cv::Vec3b>(10, 110), cv::Vec3b(255, 255, 255));
  EXPECT_LT(image.at<cv::Vec3b>(19, 122)[0], 100) << "a dash";
  EXPECT_GT(image.at<cv::Vec3b>(19, 130)[0], 200) << "a gap";
}

TEST(Drawing, Latin1KeepsItsLettersAndReplacesOthers) {
  EXPECT_EQ(latin1_of("Küche 3 m²"),
            "K\xFC"
            "che 3 m\xB2");
  EXPECT_EQ(latin1_of("部屋 1"), "?? 1");
}

}  // namespace
}  // namespace kinloop
