#pragma once
// What the targets expect of every reader.

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop::fuzz {

/// Calls `read`, which may reject its input: by an Error whose message is one line.
template <class Error = InputError, class Read>
void accept(const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos, "a message of two lines");
  }
}

/// Throws std::logic_error unless the numbers of a camera are possible.
void expect_possible(const RgbdCamera& camera);

/// Reads a source to its end, at most some frames, and throws std::logic_error unless they keep what frames
/// promise: images of the camera's size, and depth that is 0 or positive and finite.
void read_frames(FrameSource& source);

/// Opens `path` as a recording of any kind and reads its frames.
void read_recording(const std::filesystem::path& path);

/// Writes the bytes to a file of this name in a temporary folder, calls `read` with its path, and removes
/// both.
void with_file(const std::string& name, std::string_view bytes,
               const std::function<void(const std::filesystem::path&)>& read);

/// Same for a folder. The bytes hold its files: each begins with a line "-- name --".
void with_folder(std::string_view archive, const std::function<void(const std::filesystem::path&)>& read);

}  // namespace kinloop::fuzz
