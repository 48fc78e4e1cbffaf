// With AGLOW_FLUSH_TO_ZERO in the environment every row runs as a foreign library may leave the processor: subnormal
// numbers are nothing. Threads inherit it.
#include <cstdlib>

#include "support/catch.hpp"

#if defined(__SSE__)
#include <pmmintrin.h>
#include <xmmintrin.h>

namespace {

[[maybe_unused]] const bool flushed = [] {
    if (!std::getenv("AGLOW_FLUSH_TO_ZERO")) { return false; }
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    return true;
}();

#ifdef __FAST_MATH__
constexpr bool always = true;  // programs linked with -ffast-math begin so
#else
constexpr bool always = false;
#endif

}  // namespace

TEST_CASE("stability 71: a run that was asked to flush subnormal numbers to zero does") {
    volatile float small = 0x1p-126f;
    CHECK((small * 0.5f == 0) == (flushed || always));
}
#endif
