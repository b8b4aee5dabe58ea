#pragma once
// Pairs colour with depth images by the names of their files, for layouts without a list of frames.

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/datasets/recorded_sequence.hpp"

namespace kinloop {

/// A file whose name has a number in it.
struct NumberedFile {
  uint64_t number = 0;
  std::filesystem::path path;
};

/// Lists the files named `beginning`, a number, `end`; sorted by number. All files of a large folder.
std::vector<NumberedFile> numbered_files(const std::filesystem::path& folder, std::string_view beginning,
                                         std::string_view end);

/// Returns the number in a name of that form.
std::optional<uint64_t> numbered_name(const std::filesystem::path& file, std::string_view beginning,
                                      std::string_view end);

/// Compares runs of digits by value, all else by character: "2" comes before "10".
bool natural_less(std::string_view a, std::string_view b);

/// Lists the files of a folder with such names, `is_color_name` or `is_depth_name`, in natural order: 2.png
/// comes before 10.png.
std::vector<std::filesystem::path> images_in(const std::filesystem::path& folder,
                                             bool (*is_image)(const std::filesystem::path& file));

/// Pairs files of equal number; the rest is skipped. Stamps are number / `fps`. Throws InputError if no
/// number occurs in both.
std::vector<RecordedFrame> pair_by_number(const std::vector<NumberedFile>& color,
                                          const std::vector<NumberedFile>& depth, double fps);

/// Pairs two lists of stamped images by time: colour takes the nearest depth within the tolerance.
std::vector<RecordedFrame> pair_by_time(const std::vector<int64_t>& color_ns,
                                        const std::vector<std::filesystem::path>& color,
                                        const std::vector<int64_t>& depth_ns,
                                        const std::vector<std::filesystem::path>& depth);

/// Gives each frame the stamp i / `fps`.
void stamp_by_rate(std::vector<RecordedFrame>& frames, double fps);

/// Returns the rate of the median interval of the stamps; `otherwise` if there are fewer than two frames.
double median_rate_hz(const std::vector<RecordedFrame>& frames, double otherwise);

/// Sorts frames and ground truth by time; frames whose time repeats are skipped.
void keep_increasing(RecordedSequence& sequence);

/// Returns the poses sorted by time, one for each time.
Trajectory sorted_by_time(Trajectory trajectory);

/// Converts a time in seconds. Throws InputError naming `file` unless it is plausible.
int64_t checked_stamp(double seconds, const std::filesystem::path& file);

/// Makes a trajectory of the poses of single frames, without those that `pose_of_frame` does not know.
Trajectory truth_of(const std::vector<RecordedFrame>& frames,
                    const std::function<std::optional<SE3>(const RecordedFrame&, size_t)>& pose_of_frame);

}  // namespace kinloop
