#pragma once
// In: colour and depth images without a list of frames. Out: which belong together, and their times.

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/datasets/recorded_sequence.hpp"

namespace kinloop {

/// Pairs the images of two folders without any list. Equal names belong together, whatever words are in them
/// ("color_0012" and "12_depth"); images that are left are paired by the times of their names. Names that are
/// not equal are paired by their times; images without either by their order if there are as many, with a
/// warning. Images without a partner are counted, and skipped as lost unless one camera was faster. Throws
/// InputError naming the folders if nothing tells which belong together. Sets `frames`, `skipped`, `pairing`
/// and `stamps_measured`.
void pair_folders(const std::filesystem::path& color, const std::filesystem::path& depth, double fps,
                  RecordedSequence& sequence);

/// Same for two lists in natural order.
void pair_images(std::vector<std::filesystem::path> color, std::vector<std::filesystem::path> depth,
                 double fps, RecordedSequence& sequence);

/// Returns which images are in no frame.
Pairing pairing_of(const std::vector<RecordedFrame>& frames, const std::vector<std::filesystem::path>& color,
                   const std::vector<std::filesystem::path>& depth);

/// "of the nearest time within 0.02 s".
std::string nearest_time_rule();

/// Logs how images were paired that no file pairs, and how many have no partner.
void tell_pairing(const std::string& name, const Pairing& pairing);

/// "18 of 613 colour images, the first: rgb/1.png": what has no partner; empty if all have one.
std::string unpaired_text(const Pairing& pairing);

}  // namespace kinloop
