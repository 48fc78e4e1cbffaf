// All lights of a scene as one: the library's `Emitter` and `Illuminator`.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "lights.hpp"

namespace host {

/// Any one light.
template <typename T>
using any_light = std::variant<rectangle_light<T>, triangle_light<T>, sphere_light<T>, point_light<T>, sky_light<T>>;

/// Lights, chosen in proportion to their power (brightest band). Add all, then ask; asking is safe from many threads.
template <typename T>
class light_set {
public:
    using scalar = T;

    /// `primitive` is the number that a hit on the light carries, for lights that can be hit.
    void add(const any_light<T>& light, std::optional<std::uint32_t> primitive = std::nullopt) {
        const vec3<T> watts = std::visit([](const auto& l) { return l.power(); }, light);
        if (aglow::is_black(watts)) { return; }
        if (primitive) {
            if (light_at_.size() <= *primitive) { light_at_.resize(*primitive + 1, none); }
            light_at_[*primitive] = static_cast<std::uint32_t>(lights_.size());
        }
        if (std::holds_alternative<sky_light<T>>(light)) { sky_ = lights_.size(); }
        lights_.push_back(light);
        power_ += watts;
        up_to_.push_back((up_to_.empty() ? T(0) : up_to_.back()) + aglow::max_component(watts));
    }

    [[nodiscard]] bool empty() const { return lights_.empty(); }
    [[nodiscard]] std::size_t size() const { return lights_.size(); }

    /// All lights together, in watts.
    [[nodiscard]] vec3<T> power() const { return power_; }

    /// A particle of a light chosen by power; one without power where there is no light.
    template <typename R>
    [[nodiscard]] emission<T> emit(R& random) const {
        vec2<T> where = random.next_2d();
        const vec2<T> along = random.next_2d();
        if (empty()) { return {}; }
        const std::size_t i = choose(where.x);
        emission<T> e = std::visit([&](const auto& l) { return l.emit(where, along); }, lights_[i]);
        e.power /= share(i);
        return e;
    }

    template <typename R>
    [[nodiscard]] std::optional<illumination<T>> illuminate(const vec3<T>& point, R& random) const {
        vec2<T> u = random.next_2d();
        if (empty()) { return std::nullopt; }
        const std::size_t i = choose(u.x);
        auto seen = std::visit([&](const auto& l) { return l.illuminate(point, u); }, lights_[i]);
        if (seen && size() > 1) {
            seen->radiance_over_pdf /= share(i);
            seen->pdf *= share(i);
        }
        return seen;
    }

    /// Density per steradian with which `illuminate` looks from `point` at `hit`; 0 for what is no light.
    template <typename H>
    [[nodiscard]] T pdf(const vec3<T>& point, const vec3<T>&, const H& hit) const {
        if (hit.primitive >= light_at_.size() || light_at_[hit.primitive] == none) { return 0; }
        const std::size_t i = light_at_[hit.primitive];
        if (const auto* flat = std::get_if<rectangle_light<T>>(&lights_[i])) {
            return flat->pdf(point, hit.position) * share(i);
        }
        return std::visit([&](const auto& l) { return l.pdf(point, hit.position); }, lights_[i]) * share(i);
    }

    /// Radiance of the sky from `direction`; black without one.
    [[nodiscard]] vec3<T> escaped(const vec3<T>& direction) const {
        return sky_ ? std::get<sky_light<T>>(lights_[*sky_]).radiance(direction) : vec3<T>{0};
    }
    [[nodiscard]] T escaped_pdf(const vec3<T>& point, const vec3<T>& direction) const {
        return sky_ ? std::get<sky_light<T>>(lights_[*sky_]).pdf(point, direction) * share(*sky_) : T(0);
    }

private:
    static constexpr std::uint32_t none = 0xffffffffu;

    /// The light that `u` names; what is left of `u` is uniform again, so one stratified number serves for both.
    [[nodiscard]] std::size_t choose(T& u) const {
        if (size() == 1) { return 0; }
        const T at = u * up_to_.back();
        const auto found = std::upper_bound(up_to_.begin(), up_to_.end(), at);
        const std::size_t i = std::min<std::size_t>(static_cast<std::size_t>(found - up_to_.begin()), size() - 1);
        const T from = i == 0 ? T(0) : up_to_[i - 1];
        u = std::clamp((at - from) / (up_to_[i] - from), T(0), aglow::one_below<T>);
        return i;
    }
    [[nodiscard]] T share(std::size_t i) const { return (up_to_[i] - (i == 0 ? T(0) : up_to_[i - 1])) / up_to_.back(); }

    std::vector<any_light<T>> lights_{};
    std::vector<T> up_to_{};
    std::vector<std::uint32_t> light_at_{};
    std::optional<std::size_t> sky_{};
    vec3<T> power_{0};
};

}  // namespace host
