#pragma once
// What the header of a JPEG file says beside its size.

#include <string_view>

namespace kinloop {

/// Returns the number of colour components (1: grey, 3: colour, 4: CMYK), 0 if the file does not tell.
int jpeg_components(std::string_view bytes);

/// Returns how the image is to be turned for display (EXIF, tag 274): 1 for not at all, also if it does not
/// say; 3 by 180 degrees, 6 by 90 degrees clockwise, 8 counterclockwise, others mirrored.
int exif_orientation(std::string_view bytes);

}  // namespace kinloop
