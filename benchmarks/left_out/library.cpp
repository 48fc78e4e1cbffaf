#include <aglow/algorithms/path_trace.hpp>
#include <aglow/core/random.hpp>

#include "room.hpp"

float by_library(std::uint64_t count) {
    const matte_room scene;
    const centre_bulb light;
    float sum = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        sum += aglow::path_trace(scene, light, aglow::ray<float>{}, aglow::random_numbers<float>{{.path = i}});
    }
    return sum;
}
