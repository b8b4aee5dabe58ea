#pragma once
// A static page of figures and tables without scripts, for pose graphs and calibrations. (The report of a run
// is a separate page, in viewer/.)

namespace kinloop {

/// Template with the placeholders {{title}}, {{subtitle}} and {{body}}.
extern const char* const kHtmlPage;

}  // namespace kinloop
