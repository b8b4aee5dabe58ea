#pragma once
// A page of figures and tables without a program in it: of a pose graph, of a calibration. (The report of a
// run is a page of its own, in viewer/.)

namespace kinloop {

/// {{title}}, {{subtitle}} and {{body}} stand for what is filled in.
extern const char* const kHtmlPage;

}  // namespace kinloop
