// Vectors of at most N lanes. Included after hwy/highway.h, once per instruction set (hence the toggle, as in
// Highway's own headers).
#if defined(KINLOOP_BASE_HIGHWAY_COMPAT) == defined(HWY_TARGET_TOGGLE)
#ifdef KINLOOP_BASE_HIGHWAY_COMPAT
#undef KINLOOP_BASE_HIGHWAY_COMPAT
#else
#define KINLOOP_BASE_HIGHWAY_COMPAT
#endif

HWY_BEFORE_NAMESPACE();
namespace kinloop::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR  // CappedTag of Highway 0.16 (Ubuntu 22.04) lacks the scalar case
template <class T, size_t kMaxLanes>
using CappedLanes = hwy::HWY_NAMESPACE::ScalableTag<T>;
#else
template <class T, size_t kMaxLanes>
using CappedLanes = hwy::HWY_NAMESPACE::CappedTag<T, kMaxLanes>;
#endif

}  // namespace kinloop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
