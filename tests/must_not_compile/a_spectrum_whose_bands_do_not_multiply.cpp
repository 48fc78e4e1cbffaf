// expect: satisf(action of|y) 'Spectrum
#include <aglow/concepts/spectrum.hpp>

namespace {

struct near_spectrum {
    float bands[2]{};
    friend bool operator==(const near_spectrum&, const near_spectrum&) = default;
    friend near_spectrum operator+(const near_spectrum& a, const near_spectrum&) { return a; }
    friend near_spectrum operator*(const near_spectrum& a, float) { return a; }
    friend float max_component(const near_spectrum& a) { return a.bands[0]; }
#ifdef MENDED
    friend near_spectrum operator*(const near_spectrum& a, const near_spectrum&) { return a; }
#endif
};

}  // namespace

int main() { return aglow::is_black(near_spectrum{}) ? 0 : 1; }
