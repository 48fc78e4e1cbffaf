// expect: satisf(action of|y) 'Executor
#include <cstddef>

#include <aglow/core/parallel.hpp>

namespace {

struct near_executor {
#ifdef MENDED
    template <typename Task>
    void operator()(std::size_t count, Task&& task) const {
        for (std::size_t i = 0; i < count; ++i) { task(i); }
    }
#else
    template <typename Task>
    void operator()(Task&& task) const {
        task(std::size_t{});
    }
#endif
};

}  // namespace

int main() {
    aglow::for_each_block(near_executor{}, 10, 4, [](std::size_t, std::size_t, std::size_t) {});
}
