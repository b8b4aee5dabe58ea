#pragma once

namespace kinloop {

/// The page of a report; {{names}} in it stand for what is filled in.
extern const char* const kReportPage;

}  // namespace kinloop
