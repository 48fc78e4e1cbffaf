// All built-in scenes by name.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "common/scenes/cornell.hpp"
#include "common/scenes/rooms.hpp"

namespace host::scenes {

/// Every built-in scene, in the order of a list for people.
template <typename T>
[[nodiscard]] std::vector<scene_description<T>> all() {
    return {cornell_diffuse<T>(), cornell_glass<T>(), glossy_floor<T>(),      furnace<T>(),
            two_rooms<T>(),       sky_room<T>(),      translucent_sheet<T>(), point_light_box<T>()};
}

/// The scene called `name`; empty where there is none.
template <typename T>
[[nodiscard]] std::optional<scene_description<T>> find(std::string_view name) {
    for (scene_description<T>& s : all<T>()) {
        if (s.name == name) { return std::move(s); }
    }
    return std::nullopt;
}

}  // namespace host::scenes
