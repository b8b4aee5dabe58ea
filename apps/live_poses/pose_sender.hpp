#pragma once
// In: each frame as it is tracked. Out: a JSON line with its pose for another program (--poses-to);
// docs/protocol.md describes it.

#include <memory>
#include <string>

#include "kinloop/map/frames/tracked_frame.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

// In: lines, made while a run is under way. Out: the same lines at a reader, which may be slow, absent or
// gone: nothing here waits for it.

class LineOutput {
 public:
  virtual ~LineOutput() = default;

  /// Passes on a line, with its line break, as a whole. Returns false, without waiting, if it is dropped
  /// since nobody takes it.
  virtual bool write(const std::string& line) = 0;

  /// After the last line: waits a second for a reader who has taken a part of it. Returns false if it is cut.
  virtual bool finish() = 0;

  /// Returns the errno of the last line if it was dropped for another reason, such as a full disk; else 0.
  [[nodiscard]] virtual int error() const = 0;
};

/// Throws UsageError unless `target` is "-" (standard output), a file or a pipe, "unix:PATH" or
/// "udp:HOST:PORT".
void check_line_target(const std::string& target);

/// Returns whether the lines go to a file or a pipe of this name.
bool is_file_target(const std::string& target);

/// Returns whether the lines go to standard output, so that nothing else must.
bool is_standard_output_target(const std::string& target);

/// Opens an output for lines. A file is replaced at once, since its lines are read while it grows; a missing
/// folder is created. A pipe may be opened for reading at any time, and again. unix:PATH is a socket that is
/// created, for one reader of this user at a time. Throws UsageError or InputError with the remedy.
std::unique_ptr<LineOutput> open_line_output(const std::string& target);

/// Returns the line of a frame, with its line break.
std::string pose_line(const TrackedFrame& tracked, const Map& map);

class PoseSender {
 public:
  /// `target` is that of open_line_output, which may throw.
  explicit PoseSender(std::string target);

  void send(const TrackedFrame& tracked, const Map& map);

  /// Ends the lines, and logs how many were dropped and why. Returns false if they could not be written,
  /// which is not said of lines that nobody took.
  bool finish();

 private:
  std::string target_;
  std::unique_ptr<LineOutput> output_;
  size_t lines_ = 0, dropped_ = 0;  // dropped: for want of a reader
  size_t failed_ = 0;
  int error_ = 0;  // of the first that failed
};

}  // namespace kinloop
