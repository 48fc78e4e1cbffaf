// The Cornell box, in millimetres, and scenes that stand in it.
#pragma once

#include "common/scene.hpp"

namespace host::scenes {

/// Walls and camera without a lamp; the floor is of material `floor`, where given. Returns what white is.
template <typename T>
std::size_t add_cornell_walls(scene_description<T>& s, const material<T>* floor = nullptr) {
    using v = vec3<T>;
    const auto number = [](double x) { return static_cast<T>(x); };
    const auto p = [&](double x, double y, double z) { return v{number(x), number(y), number(z)}; };
    const std::size_t white = s.add({.diffuse = p(0.725, 0.71, 0.68)});
    const std::size_t red = s.add({.diffuse = p(0.63, 0.065, 0.05)});
    const std::size_t green = s.add({.diffuse = p(0.14, 0.45, 0.091)});
    const std::size_t ground = floor ? s.add(*floor) : white;
    s.add_quad(p(552.8, 0, 0), p(0, 0, 0), p(0, 0, 559.2), p(549.6, 0, 559.2), ground);
    s.add_quad(p(556, 548.8, 0), p(556, 548.8, 559.2), p(0, 548.8, 559.2), p(0, 548.8, 0), white);
    s.add_quad(p(549.6, 0, 559.2), p(0, 0, 559.2), p(0, 548.8, 559.2), p(556, 548.8, 559.2), white);
    s.add_quad(p(0, 0, 559.2), p(0, 0, 0), p(0, 548.8, 0), p(0, 548.8, 559.2), green);
    s.add_quad(p(552.8, 0, 0), p(549.6, 0, 559.2), p(556, 548.8, 559.2), p(556, 548.8, 0), red);
    s.camera = look_at(p(278, 273, -800), p(278, 273, 0), number(39.3));
    return white;
}

/// The lamp under the ceiling, 130 by 105; shines downwards, reflects nothing.
template <typename T>
void add_cornell_lamp(scene_description<T>& s) {
    const auto p = [](double x, double y, double z) {
        return vec3<T>{static_cast<T>(x), static_cast<T>(y), static_cast<T>(z)};
    };
    const std::size_t lamp = s.add({.radiance = p(17, 12, 4)});
    s.add_quad(p(343, 548.7, 227), p(343, 548.7, 332), p(213, 548.7, 332), p(213, 548.7, 227), lamp);
}

/// The two blocks, five quads each, without bottoms.
template <typename T>
void add_cornell_blocks(scene_description<T>& s, std::size_t small, std::size_t tall) {
    const auto add = [&s](std::size_t m, std::array<T, 12> c) {
        s.add_quad({c[0], c[1], c[2]}, {c[3], c[4], c[5]}, {c[6], c[7], c[8]}, {c[9], c[10], c[11]}, m);
    };
    add(small, {130, 165, 65, 82, 165, 225, 240, 165, 272, 290, 165, 114});
    add(small, {290, 0, 114, 290, 165, 114, 240, 165, 272, 240, 0, 272});
    add(small, {130, 0, 65, 130, 165, 65, 290, 165, 114, 290, 0, 114});
    add(small, {82, 0, 225, 82, 165, 225, 130, 165, 65, 130, 0, 65});
    add(small, {240, 0, 272, 240, 165, 272, 82, 165, 225, 82, 0, 225});
    add(tall, {423, 330, 247, 265, 330, 296, 314, 330, 456, 472, 330, 406});
    add(tall, {423, 0, 247, 423, 330, 247, 472, 330, 406, 472, 0, 406});
    add(tall, {472, 0, 406, 472, 330, 406, 314, 330, 456, 314, 0, 456});
    add(tall, {314, 0, 456, 314, 330, 456, 265, 330, 296, 265, 0, 296});
    add(tall, {265, 0, 296, 265, 330, 296, 423, 330, 247, 423, 0, 247});
}

/// Two white blocks in the box: every surface is Lambert's.
template <typename T>
[[nodiscard]] scene_description<T> cornell_diffuse() {
    scene_description<T> s{.name = "cornell-diffuse", .about = "the Cornell box with its two blocks, all diffuse"};
    add_cornell_lamp(s);
    const std::size_t white = add_cornell_walls(s);
    add_cornell_blocks(s, white, white);
    return s;
}

/// A sphere of glass and a mirror in the box: caustics on floor and walls.
template <typename T>
[[nodiscard]] scene_description<T> cornell_glass() {
    scene_description<T> s{.name = "cornell-glass", .about = "the Cornell box with a sphere of glass and a mirror"};
    add_cornell_lamp(s);
    add_cornell_walls(s);
    const std::size_t glass = s.add({.index = T(1.5)});
    const std::size_t mirror = s.add({.mirror = vec3<T>{T(0.9)}});
    s.add_sphere({370, 100, 230}, 100, glass);
    s.add_sphere({185, 100, 370}, 100, mirror);
    return s;
}

/// The diffuse box on a glossy floor.
template <typename T>
[[nodiscard]] scene_description<T> glossy_floor() {
    scene_description<T> s{.name = "glossy-floor", .about = "the Cornell box with its blocks on a glossy floor"};
    const material<T> glossy{
        .diffuse = vec3<T>{T(0.35), T(0.32), T(0.3)}, .glossy = vec3<T>{T(0.3)}, .roughness = T(0.15)};
    add_cornell_lamp(s);
    const std::size_t white = add_cornell_walls(s, &glossy);
    add_cornell_blocks(s, white, white);
    return s;
}

/// A sheet that lets light through hangs before the lamp's light: the transmission hemisphere.
template <typename T>
[[nodiscard]] scene_description<T> translucent_sheet() {
    scene_description<T> s{.name = "translucent-sheet",
                           .about = "the Cornell box with a hanging sheet that glows on its dark side"};
    add_cornell_lamp(s);
    add_cornell_walls(s);
    const std::size_t sheet =
        s.add({.diffuse = vec3<T>{T(0.35), T(0.3), T(0.25)}, .translucent = vec3<T>{T(0.5), T(0.45), T(0.35)}});
    // Leans back, so that the lamp shines on its far side.
    s.add_quad({130, 60, 100}, {430, 60, 100}, {430, 400, 200}, {130, 400, 200}, sheet);
    return s;
}

/// A lamp without size over a diffuse sphere.
template <typename T>
[[nodiscard]] scene_description<T> point_light_box() {
    scene_description<T> s{.name = "point-light",
                           .about = "the Cornell box with a diffuse sphere and a lamp without size"};
    const std::size_t white = add_cornell_walls(s);
    s.add_sphere({278, 130, 320}, 130, white);
    s.lamps.push_back({{180, 430, 180}, {150000, 130000, 100000}});
    return s;
}

}  // namespace host::scenes
