#pragma once

namespace kinloop {

/// The page of a pose graph; {{names}} in it stand for what is filled in.
extern const char* const kGraphPage;

}  // namespace kinloop
