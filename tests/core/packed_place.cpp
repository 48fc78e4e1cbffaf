#include <aglow/core/packed_place.hpp>

#include <algorithm>
#include <cmath>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"

using namespace aglow;

namespace {

template <typename T>
bounds<T> box_of(const vec3<T>& low, const vec3<T>& high) {
    bounds<T> box;
    box.add(low);
    box.add(high);
    return box;
}

}  // namespace

TEMPLATE_TEST_CASE("place_cells: a place reads back within half a cell on each axis, and without a shift in the mean",
                   "", float, double) {
    using T = TestType;
    const vec3<T> low{-1, 2, -8};
    const vec3<T> high{1, 10, 8};
    const place_cells<T> cells{box_of(low, high)};
    random_sampler<T> random{3};
    vec3<double> shift{};
    bool within = true;
    const int count = 200'000;
    for (int i = 0; i < count; ++i) {
        const vec3<T> u{random.next_1d(), random.next_1d(), random.next_1d()};
        const vec3<T> p = low + (high - low) * u;
        const vec3<double> off = vec3<double>{cells.centre(cells.cell(p))} - vec3<double>{p};
        shift += off;
        for (int axis = 0; axis < 3; ++axis) {
            const double half = static_cast<double>(high[axis] - low[axis]) * 0x1p-22;
            const double ulp = static_cast<double>(std::numeric_limits<T>::epsilon()) * 10;
            within = within && std::abs(off[axis]) <= half + ulp;
        }
    }
    CHECK(within);
    CHECK(cells.error() == 16 * T(0x1p-22));
    // Half a cell of [-8, 8] is 3.8e-6; a decoder at the floor of its cells would be off by that in the mean. Four
    // standard errors of an even law over the cell, and half an ulp of coordinates up to 10, whose grid a float keeps.
    const double ulp = 8 * static_cast<double>(std::numeric_limits<T>::epsilon());
    for (int axis = 0; axis < 3; ++axis) {
        const double half = static_cast<double>(high[axis] - low[axis]) * 0x1p-22;
        CHECK(std::abs(shift[axis]) / count <= 4 * half / std::sqrt(3.0 * count) + ulp / 2);
    }
}

TEST_CASE("place_cells: what lies outside goes to the nearest cell, and a box without thickness keeps its plane") {
    const place_cells<float> cells{box_of(vec3<float>{0}, vec3<float>{1, 1, 0})};
    CHECK(cells.cell({-5, 0.5f, 0}) == cells.cell({0, 0.5f, 0}));
    CHECK(cells.cell({5, 0.5f, 0}) == cells.cell({1, 0.5f, 0}));
    CHECK(cells.centre(cells.cell({0.25f, 0.5f, 0})).z == 0);
    CHECK(cells.centre(cells.cell({0.25f, 0.5f, 7})).z == 0);
    const place_cells<float> spot{box_of(vec3<float>{3, 4, 5}, vec3<float>{3, 4, 5})};
    CHECK(spot.centre(spot.cell({3, 4, 5})) == vec3<float>{3, 4, 5});
    CHECK(place_cells<float>{}.centre(place_cells<float>{}.cell({1, 2, 3})) == vec3<float>{0});
    CHECK(place_cells<float>{bounds<float>{}}.error() == 0);
}

TEST_CASE("place_cells: scaling by a power of two keeps the cells and scales their centres exactly") {
    random_sampler<float> random{9};
    for (const float scale : {0x1p-40f, 0x1p-3f, 0x1p40f}) {
        const place_cells<float> here{box_of(vec3<float>{-1, 0, 3}, vec3<float>{2, 7, 3.5f})};
        const place_cells<float> there{box_of(vec3<float>{-1, 0, 3} * scale, vec3<float>{2, 7, 3.5f} * scale)};
        bool same = true;
        for (int i = 0; i < 1000; ++i) {
            const vec3<float> p{3 * random.next_1d() - 1, 7 * random.next_1d(), 3 + random.next_1d() / 2};
            same = same && here.cell(p) == there.cell(p * scale) &&
                   there.centre(there.cell(p * scale)) == here.centre(here.cell(p)) * scale;
        }
        CHECK(same);
    }
}
