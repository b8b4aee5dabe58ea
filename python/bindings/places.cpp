#include <map>

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/features/extraction/extractor.hpp"
#include "kinloop/place/place_index.hpp"
#include "kinloop/place/vocabulary/default_vocabulary.hpp"
#include "kinloop/place/vocabulary/vocabulary_file.hpp"
#include "kinloop/sensor/sensor.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/gil.hpp"
#include "python/bindings/options.hpp"
#include "tools/vocabulary_training/descriptors/training_images.hpp"
#include "tools/vocabulary_training/trainer.hpp"

namespace kinloop::python {
namespace {

/// Returns the ORB descriptors of a grey image.
cv::Mat orb_descriptors(const cv::Mat& gray) {
  PinholeCamera camera;  // without distortion; descriptors do not depend on the other parameters
  camera.width = gray.cols;
  camera.height = gray.rows;
  camera.fx = camera.fy = gray.cols;
  return extract_features(gray, {}, Sensor{camera}, {}).descriptors;
}

Vocabulary train(const std::vector<std::filesystem::path>& inputs, const py::object& progress,
                 const py::kwargs& keywords) {
  TrainOptions options;
  options.threads = hardware_threads();
  options = with_assignments(options, assignments_of(keywords));
  PythonProgress reporter(progress);
  Vocabulary vocabulary = without_gil([&] {
    const DescribeOptions description{{}, DescriptorKind::kOrb, options.threads};
    auto loaded = read_training_set(list_training_input(inputs), description, reporter.function());
    return train_vocabulary(std::move(loaded.set), options, reporter.function());
  });
  reporter.rethrow();
  return vocabulary;
}

void bind_vocabulary(py::module_& module) {
  py::class_<Vocabulary>(module, "Vocabulary", "Visual words: a tree of ORB descriptors.")
      .def_static("default", &load_default_vocabulary, "Returns the built-in vocabulary.")
      .def_static("load", &read_vocabulary, py::arg("path"), "Reads a .kinvoc file. Raises InputError.")
      .def_static("train", &train, py::arg("inputs"), py::arg("progress") = py::none(),
                  R"(Trains a vocabulary.

inputs: paths of image files, folders of images, sequences in TUM layout and .kindesc files.
Keywords are those of kinloop vocab train: branching, depth, seeding, iterations, seed, threads, ... The same input and
seed give the same vocabulary. Raises InputError for too few images.)")
      .def(
          "save", [](const Vocabulary& v, const std::filesystem::path& path) { write_vocabulary(path, v); },
          py::arg("path"), "Writes a .kinvoc file.")
      .def(
          "words_of",
          [](const Vocabulary& vocabulary, const py::array& image) {
            const cv::Mat gray = gray_image(image, "image");
            return without_gil([&] {
              std::map<uint32_t, float> weights;
              for (const auto& [word, weight] :
                   vocabulary.bow_of(vocabulary.quantize(orb_descriptors(gray)).words))
                weights[word.value] = weight;
              return weights;
            });
          },
          py::arg("image"),
          "Returns the words of an image, uint8 (H, W, 3) or (H, W), with their weights, which sum to 1.")
      .def("__len__", &Vocabulary::word_count)
      .def("__repr__",
           [](const Vocabulary& v) { return fmt::format("<kinloop.Vocabulary: {} words>", v.word_count()); });
}

/// An index of images under the caller's numbers.
class ImageIndex {
 public:
  explicit ImageIndex(Vocabulary vocabulary) : vocabulary_(std::move(vocabulary)) {}

  void add(uint32_t number, const cv::Mat& gray) {
    if (number == KeyframeId::kNone || places_.contains(KeyframeId{number}))
      throw UsageError(fmt::format("add({}): the index has this number already", number));
    places_.add(KeyframeId{number}, words(gray));
  }
  void remove(uint32_t number) {
    if (!places_.contains(KeyframeId{number}))
      throw UsageError(fmt::format("remove({}): not in the index", number));
    places_.remove(KeyframeId{number});
  }
  [[nodiscard]] std::vector<std::pair<uint32_t, double>> query(const cv::Mat& gray,
                                                               size_t max_results) const {
    std::vector<std::pair<uint32_t, double>> found;
    for (const auto& candidate : places_.query(words(gray), max_results))
      found.emplace_back(candidate.keyframe.value, candidate.score);
    return found;
  }
  [[nodiscard]] bool contains(uint32_t number) const { return places_.contains(KeyframeId{number}); }
  [[nodiscard]] size_t size() const { return places_.size(); }

 private:
  [[nodiscard]] BowVector words(const cv::Mat& gray) const {
    return vocabulary_.bow_of(vocabulary_.quantize(orb_descriptors(gray)).words);
  }

  Vocabulary vocabulary_;
  PlaceIndex places_;
};

}  // namespace

void bind_places(py::module_& module) {
  bind_vocabulary(module);
  py::class_<ImageIndex>(module, "PlaceIndex", R"(Finds images of the same place.

PlaceIndex(vocabulary=None): with the built-in vocabulary by default. Not for several threads at once.)")
      .def(py::init([](const std::optional<Vocabulary>& vocabulary) {
             return ImageIndex(vocabulary ? *vocabulary : load_default_vocabulary());
           }),
           py::arg("vocabulary") = py::none())
      .def(
          "add",
          [](ImageIndex& index, uint32_t number, const py::array& image) {
            index.add(number, gray_image(image, "image"));
          },
          py::arg("number"), py::arg("image"),
          "Adds an image, uint8 (H, W, 3), red first, or (H, W), under a number of your choice.")
      .def("remove", &ImageIndex::remove, py::arg("number"), "Removes an image.")
      .def(
          "query",
          [](const ImageIndex& index, const py::array& image, size_t max_results) {
            return index.query(gray_image(image, "image"), max_results);
          },
          py::arg("image"), py::arg("max_results") = 5,
          "Returns the most similar images as (number, score), best first; a score is 1 for the same words "
          "and 0 for "
          "none in common.")
      .def("__contains__", &ImageIndex::contains)
      .def("__len__", &ImageIndex::size);
}

}  // namespace kinloop::python
