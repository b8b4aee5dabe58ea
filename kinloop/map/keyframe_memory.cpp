#include "kinloop/map/keyframe_memory.hpp"

#include <type_traits>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

static_assert(std::is_trivially_destructible_v<Patch>);  // it is read from the file in place

std::span<const uint8_t> descriptor_bytes(const Keyframe& keyframe) {
  const cv::Mat& descriptors = keyframe.features->descriptors;
  if (!descriptors.isContinuous()) return {};  // none in practice
  return {descriptors.data, descriptors.total() * descriptors.elemSize()};
}

std::span<const uint8_t> patch_bytes(const Keyframe& keyframe) {
  if (keyframe.patches == nullptr) return {};
  const std::span<const Patch> patches = keyframe.patches->patches();
  return {reinterpret_cast<const uint8_t*>(patches.data()), patches.size_bytes()};
}

}  // namespace

void KeyframeMemory::apply_limit(Map& map) {
  for (; map.contains(KeyframeId{next_counted_}); ++next_counted_) {
    const Keyframe& keyframe = map.keyframe(KeyframeId{next_counted_});
    bytes_in_memory_ += descriptor_bytes(keyframe).size() + patch_bytes(keyframe).size();
  }
  const size_t on_disk_before = bytes_on_disk();
  try {
    while (!failed_ && bytes_in_memory_ > limit_bytes_ && next_moved_ < next_counted_)
      move_to_disk(map, KeyframeId{next_moved_++});
  } catch (const InputError& error) {
    failed_ = true;
    log::warn("{}. All descriptors of the map stay in memory", error.what());
  }
  // What is written soon fills the memory of the pages that were read.
  if (bytes_on_disk() > on_disk_before) file_.drop_pages();
}

void KeyframeMemory::move_to_disk(Map& map, KeyframeId id) {
  const Keyframe& keyframe = map.keyframe(id);
  if (const auto bytes = descriptor_bytes(keyframe); !bytes.empty()) {
    Features features = *keyframe.features;
    const cv::Mat& before = keyframe.features->descriptors;
    features.descriptor_storage = file_.add(bytes);
    // OpenCV has no matrices of constant data; nobody writes to the descriptors of a keyframe.
    features.descriptors = cv::Mat(before.rows, before.cols, before.type(),
                                   const_cast<uint8_t*>(features.descriptor_storage.get()));
    bytes_in_memory_ -= bytes.size();
    map.set_features(id, std::make_shared<const Features>(std::move(features)));
  }
  if (const auto bytes = patch_bytes(keyframe); !bytes.empty()) {
    const auto storage = file_.add(bytes);
    bytes_in_memory_ -= bytes.size();
    map.set_patches(id, {*keyframe.patches, {storage, reinterpret_cast<const Patch*>(storage.get())}});
  }
}

}  // namespace kinloop
