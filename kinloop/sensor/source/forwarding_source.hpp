#pragma once
// The base of sources that change or delay the frames of another one.

#include <memory>
#include <utility>

#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// Owns a source, whose camera, properties and skipped frames are its own unless overridden.
class ForwardingSource : public FrameSource {
 public:
  [[nodiscard]] const RgbdCamera& camera() const override { return source_->camera(); }
  [[nodiscard]] const SourceInfo& info() const override { return source_->info(); }
  [[nodiscard]] SkippedFrames skipped() const override { return source_->skipped(); }

  /// Returns the source whose frames these are.
  [[nodiscard]] const FrameSource& inner() const { return *source_; }

 protected:
  /// Throws std::logic_error for a null pointer.
  explicit ForwardingSource(std::unique_ptr<FrameSource> source) : source_(std::move(source)) {
    require(source_ != nullptr, "ForwardingSource: needs a source");
  }

  [[nodiscard]] FrameSource& source() { return *source_; }
  [[nodiscard]] const FrameSource& source() const { return *source_; }

 private:
  std::unique_ptr<FrameSource> source_;
};

}  // namespace kinloop
