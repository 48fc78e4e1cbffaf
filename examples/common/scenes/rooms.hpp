// Rooms and furnaces, in metres.
#pragma once

#include "common/scene.hpp"

namespace host::scenes {

/// A box from `low` to `high` that is seen from inside: six quads, or fewer where a wall's bit (-x +x -y +y -z +z) is
/// not in `walls`.
template <typename T>
void add_room(scene_description<T>& s, const vec3<T>& low, const vec3<T>& high, std::size_t m, unsigned walls = 63) {
    const T a = low.x, b = low.y, c = low.z, x = high.x, y = high.y, z = high.z;
    if (walls & 1u) { s.add_quad({a, b, c}, {a, y, c}, {a, y, z}, {a, b, z}, m); }
    if (walls & 2u) { s.add_quad({x, b, c}, {x, b, z}, {x, y, z}, {x, y, c}, m); }
    if (walls & 4u) { s.add_quad({a, b, c}, {a, b, z}, {x, b, z}, {x, b, c}, m); }
    if (walls & 8u) { s.add_quad({a, y, c}, {x, y, c}, {x, y, z}, {a, y, z}, m); }
    if (walls & 16u) { s.add_quad({a, b, c}, {x, b, c}, {x, y, c}, {a, y, c}, m); }
    if (walls & 32u) { s.add_quad({a, b, z}, {a, y, z}, {x, y, z}, {x, b, z}, m); }
}

/// A wall in the plane x = `at` over z in [from, to], up to `height`, with a hole of `hole` = (low z, low y, high z,
/// high y).
template <typename T>
void add_wall_with_hole(scene_description<T>& s, T at, T from, T to, T height, const std::array<T, 4>& hole,
                        std::size_t m) {
    const auto piece = [&](T z0, T y0, T z1, T y1) {
        if (z1 > z0 && y1 > y0) { s.add_quad({at, y0, z0}, {at, y0, z1}, {at, y1, z1}, {at, y1, z0}, m); }
    };
    piece(from, 0, hole[0], height);
    piece(hole[2], 0, to, height);
    piece(hole[0], 0, hole[2], hole[1]);
    piece(hole[0], hole[3], hole[2], height);
}

/// A closed box and a sphere that all send out 1/2 and reflect 1/2: radiance is 1 wherever one looks.
template <typename T>
[[nodiscard]] scene_description<T> furnace() {
    scene_description<T> s{.name = "furnace", .about = "a closed room that glows evenly: every pixel is 1"};
    const std::size_t glow = s.add({.diffuse = vec3<T>{T(0.5)}, .radiance = vec3<T>{T(0.5)}});
    add_room(s, {-1, -1, -1}, {1, 1, 1}, glow);
    s.add_sphere({T(0.25), T(-0.5), T(0.25)}, T(0.375), glow);
    s.camera = look_at<T>({T(-0.5), T(0.25), T(-0.875)}, {T(0.25), T(-0.25), T(0.25)}, 70);
    return s;
}

/// The lamp is in the next room and the door ajar: almost all light here has come round the corner.
template <typename T>
[[nodiscard]] scene_description<T> two_rooms() {
    scene_description<T> s{.name = "two-rooms", .about = "a lamp in the next room, seen through a door ajar"};
    const std::size_t wall = s.add({.diffuse = vec3<T>{T(0.75), T(0.72), T(0.68)}});
    const std::size_t floor = s.add({.diffuse = vec3<T>{T(0.5), T(0.4), T(0.3)}});
    const std::size_t wood = s.add({.diffuse = vec3<T>{T(0.55), T(0.35), T(0.2)}});
    const std::size_t blue = s.add({.diffuse = vec3<T>{T(0.3), T(0.4), T(0.65)}});
    const std::size_t lamp = s.add({.radiance = vec3<T>{80, 70, 50}});
    const T height = T(2.5);
    const T top = height - T(1) / 64;
    s.add_quad({5, top, T(1.5)}, {6, top, T(1.5)}, {6, top, T(2.5)}, {5, top, T(2.5)}, lamp);
    add_room(s, {0, 0, 0}, {8, height, 4}, wall, 63u & ~4u);
    add_room(s, {0, 0, 0}, {8, height, 4}, floor, 4u);
    add_wall_with_hole<T>(s, 4, 0, 4, height, {T(1.5), T(0), T(2.5), T(2)}, wall);
    // Hinged at z = 2.5, opened into the far room by 36.87 degrees.
    s.add_quad({4, 0, T(2.5)}, {T(4.6), 0, T(1.7)}, {T(4.6), 2, T(1.7)}, {4, 2, T(2.5)}, wood);
    s.add_sphere({T(2.75), T(0.5), T(2.875)}, T(0.5), blue);
    s.camera = look_at<T>({T(0.25), T(1.4), T(0.5)}, {4, T(1.1), T(2.25)}, 55);
    return s;
}

/// A room lit by the sky through its one window.
template <typename T>
[[nodiscard]] scene_description<T> sky_room() {
    scene_description<T> s{.name = "sky-room", .about = "a room lit by the sky through one window"};
    const std::size_t wall = s.add({.diffuse = vec3<T>{T(0.75), T(0.75), T(0.72)}});
    const std::size_t floor = s.add({.diffuse = vec3<T>{T(0.45), T(0.32), T(0.22)}});
    const std::size_t red = s.add({.diffuse = vec3<T>{T(0.6), T(0.15), T(0.1)}});
    add_room(s, {0, 0, 0}, {5, T(2.75), 4}, wall, 63u & ~4u & ~2u);
    add_room(s, {0, 0, 0}, {5, T(2.75), 4}, floor, 4u);
    add_wall_with_hole<T>(s, 5, 0, 4, T(2.75), {T(1.25), T(0.75), T(2.75), T(2.25)}, wall);
    add_room(s, {2, 0, T(2.5)}, {3, T(0.75), T(3.5)}, red, 63u & ~4u);
    // Its normal, along x across, points into the room (-x).
    s.sky = sky<T>{.ground = vec3<T>{T(1.2), T(1.1), T(0.9)},
                   .horizon = vec3<T>{6, 7, 8},
                   .zenith = vec3<T>{3, 5, 10},
                   .window = rectangle<T>{{5, T(0.75), T(1.25)}, {0, 0, 1}, {0, 1, 0}, T(1.5), T(1.5)}};
    s.camera = look_at<T>({T(0.25), T(1.6), T(0.5)}, {4, T(0.9), T(2.6)}, 60);
    return s;
}

}  // namespace host::scenes
