// A host's first program: it uses the library, and would not pass the library's own warnings.
#include <cstdio>

#include <aglow/aglow.hpp>

int main(int count, char**) {
    unsigned not_our_style = count;
    aglow::bounds<float> box;
    box.add({1.0f, 2.0f, 3.0f});
    std::printf("aglow %d.%d.%d\n", aglow::version.major, aglow::version.minor, aglow::version.patch);
    return not_our_style == 1 && box.contains({1.0f, 2.0f, 3.0f}) ? 0 : 1;
}
