// Recognizes places: for each image, prints the most similar earlier images.
//
//   example_detect_place IMAGE...

#include <cstdio>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/features/extraction/extractor.hpp"
#include "kinloop/place/place_index.hpp"
#include "kinloop/place/vocabulary/default_vocabulary.hpp"

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fprintf(stderr, "usage: example_detect_place IMAGE IMAGE...\n");
    return 2;
  }
  const kinloop::Vocabulary vocabulary = kinloop::load_default_vocabulary();
  kinloop::PlaceIndex places;
  for (int i = 1; i < argc; ++i) {
    const cv::Mat gray = kinloop::read_color_image(argv[i]).gray();
    kinloop::PinholeCamera camera;  // without distortion; descriptors do not depend on the other parameters
    camera.width = gray.cols;
    camera.height = gray.rows;
    camera.fx = camera.fy = gray.cols;

    const auto features = kinloop::extract_features(gray, {}, {camera}, {});
    const auto bow = vocabulary.bow_of(vocabulary.quantize(features.descriptors).words);
    std::printf("%s\n", argv[i]);
    for (const auto& candidate : places.query(bow, 3)) {
      std::printf("  %.3f  %s\n", candidate.score, argv[candidate.keyframe.value]);
    }
    places.add(kinloop::KeyframeId{static_cast<uint32_t>(i)}, bow);
  }
} catch (const kinloop::InputError& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 3;
}
