#pragma once
// Runs a test body once for every instruction set of this machine, including plain C++.

#include <functional>
#include <string>

#include <hwy/targets.h>

namespace kinloop::test {

/// Applies SetSupportedTargetsForTest, in the way of each Highway version.
template <class ChosenTarget>
void update_chosen_target(ChosenTarget& chosen) {
  if constexpr (requires { chosen.Update(hwy::SupportedTargets()); }) {
    chosen.Update(hwy::SupportedTargets());
  } else {
    chosen.Update();  // before 1.0
  }
}

/// Restricts Highway to one instruction set (0 = all that the CPU has).
inline void force_simd_target(decltype(hwy::SupportedTargets()) target) {
  hwy::SetSupportedTargetsForTest(target);
  update_chosen_target(hwy::GetChosenTarget());
}

/// Calls `body` with the name of each instruction set while that one is active; then restores the CPU's own.
inline void for_each_simd_target(const std::function<void(const std::string&)>& body) {
  const auto all = hwy::SupportedTargets();
  for (auto left = all; left != 0; left &= left - 1) {
    const auto target = left & -left;
    if ((target & HWY_TARGETS) == 0) continue;
    force_simd_target(target);
    body(hwy::TargetName(target));
  }
  force_simd_target(0);
}

}  // namespace kinloop::test
