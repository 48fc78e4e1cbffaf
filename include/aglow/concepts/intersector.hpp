// The host's ray tracer, as the library sees it: two questions.
#pragma once

#include <algorithm>
#include <concepts>
#include <type_traits>
#include <utility>

#include <aglow/concepts/surface.hpp>
#include <aglow/core/bounds.hpp>
#include <aglow/core/ray.hpp>

namespace aglow {

/// The scalar of a host's scene: its member type `scalar`, else float.
template <typename S>
struct scalar_of_type {
    using type = float;
};
template <typename S>
    requires std::floating_point<typename S::scalar>
struct scalar_of_type<S> {
    using type = typename S::scalar;
};
template <typename S>
using scalar_of = typename scalar_of_type<std::remove_cvref_t<S>>::type;

/// A point of the host's scene.
template <typename S>
using point_of = vec3<scalar_of<S>>;

/// The host's ray tracer, seen through two questions. Both may be asked from several threads at once.
///
/// - `intersect(ray)`: the nearest hit in front of the origin and before `ray.reach`, as an optional-like `Hit`.
/// - `occluded(a, b)`: whether anything lies strictly between the two points. Both are already lifted off their
///   surfaces. Of light from beyond the scene `intersect` is asked instead.
/// - optional `static constexpr lobe_set possible_lobes` (or a const member function of that name): the lobes that the
///   scene can have; what it cannot have is left out.
/// - member type `scalar` where it is not float: rays and hits are made of it.
/// - optional `bounds()`: the `aglow::bounds` of the geometry; what lengths are measured by where a host gives none.
///
/// Must be true: the hit is the nearest; occluded(a, b) = occluded(b, a).
template <typename S>
concept Intersector = requires(const S& scene, const ray<scalar_of<S>>& r, point_of<S> a, point_of<S> b) {
    { scene.occluded(a, b) } -> std::convertible_to<bool>;
    static_cast<bool>(scene.intersect(r));
    requires Hit<std::remove_cvref_t<decltype(*scene.intersect(r))>>;
    scene.intersect(r)->position;
    requires std::same_as<hit_scalar<std::remove_cvref_t<decltype(*scene.intersect(r))>>, scalar_of<S>>;
};

/// What a scene's `intersect` finds.
template <Intersector S>
using hit_of = std::remove_cvref_t<decltype(*std::declval<const S&>().intersect(ray<scalar_of<S>>{}))>;

/// An intersector whose hits scatter light: what tracing needs.
template <typename S>
concept Scene = Intersector<S> && Surface<hit_of<S>>;

/// The colour that a scene's surfaces scatter.
template <Scene S>
using spectrum_of = surface_spectrum<hit_of<S>>;

/// Whether the scene states its lobes at compile time.
template <typename S>
concept StatesLobes = requires {
    typename std::integral_constant<lobe_set, std::remove_cvref_t<S>::possible_lobes>;
};

/// The lobes that surfaces of type `S` can have, as a constant: all, where the type does not say.
template <typename S>
inline constexpr lobe_set static_lobes = [] {
    if constexpr (StatesLobes<S>) {
        return lobe_set{std::remove_cvref_t<S>::possible_lobes};
    } else {
        return lobe_set::all;
    }
}();

/// The lobes that this scene can have: stated by its type, else by its member function, else all.
template <typename S>
[[nodiscard]] constexpr lobe_set possible_lobes(const S& scene) {
    if constexpr (StatesLobes<S>) {
        return static_lobes<S>;
    } else if constexpr (requires {
                             { scene.possible_lobes() } -> std::convertible_to<lobe_set>;
                         }) {
        return scene.possible_lobes();
    } else {
        return lobe_set::all;
    }
}

/// How far `hit`, found along a ray from `origin`, may lie from the true surface.
template <Hit H>
[[nodiscard]] hit_scalar<H> error_of(const H& hit, const vec3<hit_scalar<H>>& origin) {
    if constexpr (requires {
                      { hit.position_error } -> std::convertible_to<hit_scalar<H>>;
                  }) {
        return hit.position_error;
    } else {
        return position_error(std::max(max_abs(vec3<hit_scalar<H>>(hit.position)), max_abs(origin)));
    }
}

}  // namespace aglow
