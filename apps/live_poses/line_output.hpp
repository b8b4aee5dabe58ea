#pragma once
// In: lines, made while a run is under way. Out: the same lines at a reader, which may be slow, absent or
// gone: nothing here waits for it.

#include <memory>
#include <string>

namespace kinloop {

class LineOutput {
 public:
  virtual ~LineOutput() = default;

  /// Passes on a line, with its line break, as a whole. Returns false, without waiting, if it is dropped
  /// since nobody takes it.
  virtual bool write(const std::string& line) = 0;
};

/// Throws UsageError unless `target` is "-" (standard output), a file or a pipe, "unix:PATH" or
/// "udp:HOST:PORT".
void check_line_target(const std::string& target);

/// Returns whether the lines go to standard output, so that nothing else must.
bool is_standard_output_target(const std::string& target);

/// Opens an output for lines. A file is replaced at once, since its lines are read while it grows; a missing
/// folder is created. A pipe may be opened for reading at any time, and again. unix:PATH is a socket that is
/// created, for one reader of this user at a time. Throws UsageError or InputError with the remedy.
std::unique_ptr<LineOutput> open_line_output(const std::string& target);

}  // namespace kinloop
