#pragma once
// Where depth jumps: the borders of near objects, which are also edges in a registered colour image.

namespace kinloop {

/// Walks along `length` pixels of a row or column and calls `add_border` with the index of each pixel of a
/// near object next to a far one, or with a gap of at most `max_shadow_px` without depth between the two,
/// where the projector does not shine. `depth_at` returns the depth at an index in metres, 0 = unknown.
template <class DepthAt, class AddBorder>
void find_depth_borders(int length, int max_shadow_px, const DepthAt& depth_at, const AddBorder& add_border) {
  constexpr float kJump = 1.08F;  // farther than the neighbour by this factor: another object
  int previous = -1;
  float previous_m = 0;
  for (int i = 0; i < length; ++i) {
    const float depth_m = depth_at(i);
    if (!(depth_m > 0)) continue;
    const bool adjacent = previous >= 0 && i - previous <= max_shadow_px;
    if (adjacent && depth_m > kJump * previous_m) add_border(previous);
    if (adjacent && previous_m > kJump * depth_m) add_border(i);
    previous = i;
    previous_m = depth_m;
  }
}

}  // namespace kinloop
