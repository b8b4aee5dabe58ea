#pragma once
// Sources that know where their next frame ends without reading it.

namespace kinloop {

/// Implemented by a FrameSource that can pass over frames without decoding or rendering them.
class PassableSource {
 public:
  virtual ~PassableSource() = default;

  /// Passes over the next frame, whether or not it is damaged; false at the end.
  virtual bool pass_over() = 0;
};

}  // namespace kinloop
