#include "drivers/datasets/reading/lists/frame_masks.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "drivers/datasets/folder_contents.hpp"
#include "drivers/image_files/image_file.hpp"
#include "drivers/images/mask_image.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {

void find_masks(const std::filesystem::path& folder, RecordedSequence& sequence) {
  const auto masks = folder / "masks";
  std::error_code absent;
  if (!std::filesystem::is_directory(masks, absent) || sequence.frames.empty()) return;
  bool found = false;
  for (RecordedFrame& frame : sequence.frames) {
    const auto file = masks / (frame.color.file.stem().string() + ".png");
    if (!std::filesystem::exists(file, absent)) continue;
    frame.mask = file;
    found = true;
  }
  if (found) return;
  const std::string any = FolderContents(masks).first_image();
  if (any.empty()) return;
  throw InputError(
      fmt::format("{}: not the name of a colour image; call the mask of {} {}.png, or rename the "
                  "folder if it holds no masks",
                  (masks / any).string(), sequence.frames.front().color.file.filename().string(),
                  sequence.frames.front().color.file.stem().string()));
}

void require_usable_masks(const RecordedSequence& sequence, const cv::Size& size) {
  constexpr int kLooked = 3;  // a wrong convention concerns most masks
  int looked = 0;
  for (const RecordedFrame& frame : sequence.frames) {
    if (frame.mask.empty()) continue;
    try {
      if (cv::countNonZero(read_frame_mask(frame, size)) > 0) return;
    } catch (const MaskFormatError&) {
      throw;
    } catch (const InputError&) {
      continue;  // damaged: the frame will be skipped
    }
    if (++looked < kLooked) continue;
    throw InputError(
        fmt::format("{}: all pixels are black, which means to be ignored, as in the masks before it; "
                    "what is to be used must be white",
                    frame.mask.string()));
  }
}

cv::Mat read_frame_mask(const RecordedFrame& frame, const cv::Size& size) {
  if (frame.mask.empty()) return {};
  return decode_mask(read_image_bytes(frame.mask), size, frame.mask.string());
}

}  // namespace kinloop
