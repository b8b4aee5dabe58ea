#include "python/bindings/array_frame.hpp"

#include <cmath>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/errors.hpp"
#include "python/bindings/gil.hpp"

namespace kinloop::python {
namespace {

/// Holds a reference to the Python object whose memory a cv::Mat shares.
class SharedMemory : public cv::MatAllocator {
 public:
  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, size_t* step, cv::AccessFlag flags,
                         cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(dims, sizes, type, data, step, flags, usage);
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag access, cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(data, access, usage);
  }
  void deallocate(cv::UMatData* data) const override {
    {
      const py::gil_scoped_acquire gil;  // the last user of an image may be a worker thread
      Py_XDECREF(static_cast<PyObject*>(data->userdata));
    }
    delete data;
  }
};

/// Lets `image`, whose pixels belong to `owner`, keep it alive.
cv::Mat keep_alive(cv::Mat image, const py::object& owner) {
  static const SharedMemory kAllocator;
  auto* data = new cv::UMatData(&kAllocator);  // freed by deallocate
  data->data = data->origdata = image.data;
  data->size = image.step[0] * static_cast<size_t>(image.rows);
  data->userdata = owner.inc_ref().ptr();
  data->refcount = 1;
  image.u = data;
  return image;
}

/// How an image comes to have the size that the camera has.
const char* size_remedy(const cv::Mat& image, const PinholeCamera& camera, bool depth) {
  if (image.cols == camera.height && image.rows == camera.width)
    return "an array has its height first: np.swapaxes(image, 0, 1)";
  if (depth) return "register depth to colour, or give kinloop.Camera its own camera: depth={fx, fy, cx, cy}";
  return "give kinloop.Camera the width, height, fx, fy, cx and cy of these images";
}

void require_size(const cv::Mat& image, const PinholeCamera& camera, const std::string& name) {
  if (image.cols == camera.width && image.rows == camera.height) return;
  throw UsageError(fmt::format("{}: {} x {} pixels where the camera has {} x {}; {}", name, image.cols,
                               image.rows, camera.width, camera.height,
                               size_remedy(image, camera, name == "depth")));
}

constexpr float kMaxDepthM = 1e4F;

/// Whether every pixel is a distance or 0, in metres.
bool holds_distances(const cv::Mat& depth) {
  return cv::checkRange(depth, true, nullptr, 0, double{kMaxDepthM});
}

/// Metres with 0 for all that is no distance.
cv::Mat checked_metres(const cv::Mat& depth) {
  cv::Mat metres;
  depth.convertTo(metres, CV_32FC1);
  for (int y = 0; y < metres.rows; ++y) {
    auto* row = metres.ptr<float>(y);
    for (int x = 0; x < metres.cols; ++x) row[x] = row[x] > 0 && row[x] < kMaxDepthM ? row[x] : 0.0F;
  }
  return metres;
}

cv::Mat as_bgr(const ArrayImage& color) {
  cv::Mat bgr;
  if (color.bgr) {
    color.pixels.copyTo(bgr);
  } else {
    cv::cvtColor(color.pixels, bgr, cv::COLOR_RGB2BGR);
  }
  return bgr;
}

}  // namespace

ArrayFrame frame_of_arrays(const py::array& rgb, const py::array& depth, const RgbdCamera& camera,
                           const ArrayConversion& conversion) {
  const ArrayImage color = rgb_image(rgb, "rgb");
  const cv::Mat measured = depth_image(depth, "depth");
  require_size(color.pixels, camera.color, "rgb");
  require_size(measured, camera.depth ? *camera.depth : camera.color, "depth");
  const bool share_color = !conversion.copy && color.bgr;
  const bool share_depth = !conversion.copy && measured.data == depth.data() && measured.type() == CV_32FC1 &&
                           camera.depth_shift_m == 0 &&  // a shift works on the pixels
                           without_gil([&] { return holds_distances(measured); });
  ArrayFrame frame;
  cv::Mat shared_color, shared_depth;
  if (share_color) shared_color = keep_alive(color.pixels, rgb);
  if (share_depth) shared_depth = keep_alive(measured, depth);
  without_gil([&] {
    frame.color = share_color ? shared_color : as_bgr(color);
    if (share_depth) {
      frame.depth_m = shared_depth;
    } else {
      frame.depth_m = measured.type() == CV_16UC1 ? from_depth_units(measured, conversion.depth_scale)
                                                  : checked_metres(measured);
    }
  });
  return frame;
}

}  // namespace kinloop::python
