// expect: satisf(action of|y) 'Numbers
#include <aglow/concepts/sampler.hpp>

namespace {

struct near_numbers {
    aglow::random_sampler<float> at(std::uint32_t, aglow::purpose) const { return aglow::random_sampler<float>{1}; }
#ifdef MENDED
    near_numbers fork(std::uint64_t) const { return *this; }
#endif
};

template <aglow::Numbers N>
void walk(const N&) {}

}  // namespace

int main() { walk(near_numbers{}); }
