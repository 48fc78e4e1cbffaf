// The smallest host that satisfies each concept and no more: what an algorithm is instantiated with to show that it
// asks for nothing beyond its concepts. All of them keep the laws too, so the answers mean something: the scene is the
// inside of a matte unit sphere of albedo 1/2 with a point light at its centre, where the irradiance is everywhere I (1
// + 1) and the radiance is I / pi for a light of intensity I.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>

#include <aglow/concepts/intersector.hpp>
#include <aglow/concepts/light.hpp>
#include <aglow/concepts/sampler.hpp>
#include <aglow/concepts/spectrum.hpp>
#include <aglow/concepts/surface.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/warp.hpp>

namespace archetypes {

using aglow::lobe_set;
using aglow::vec3;

/// Two bands of light, and not an operation beyond the concept: no order, no difference, no scalar on the left, no
/// compound assignment, no conversion of the scalar.
template <std::floating_point T>
class spectrum {
public:
    spectrum() = default;
    static constexpr spectrum of(T a, T b) { return spectrum{a, b}; }
    [[nodiscard]] constexpr const std::array<T, 2>& bands() const { return bands_; }

    friend bool operator==(const spectrum&, const spectrum&) = default;
    friend constexpr spectrum operator+(const spectrum& a, const spectrum& b) {
        return {a.bands_[0] + b.bands_[0], a.bands_[1] + b.bands_[1]};
    }
    friend constexpr spectrum operator*(const spectrum& a, const spectrum& b) {
        return {a.bands_[0] * b.bands_[0], a.bands_[1] * b.bands_[1]};
    }
    template <std::same_as<T> K>
    friend constexpr spectrum operator*(const spectrum& a, K k) {
        return {a.bands_[0] * k, a.bands_[1] * k};
    }
    friend constexpr T max_component(const spectrum& a) {
        if (!aglow::is_finite(a.bands_[0])) { return a.bands_[0]; }
        if (!aglow::is_finite(a.bands_[1])) { return a.bands_[1]; }
        return a.bands_[0] > a.bands_[1] ? a.bands_[0] : a.bands_[1];
    }
    friend constexpr spectrum white(std::type_identity<spectrum>) { return {T(1), T(1)}; }

private:
    constexpr spectrum(T a, T b) : bands_{a, b} {}
    std::array<T, 2> bands_{};
};

/// A point of the host's own kind: coordinates to read, and the way into the library's vectors.
template <std::floating_point T>
struct point {
    T x;
    T y;
    T z;
    operator vec3<T>() const { return {x, y, z}; }  // NOLINT: as above
};

/// A direction of the host's own kind, of which only the way into the library's vectors is known.
template <std::floating_point T>
class direction {
public:
    explicit direction(const vec3<T>& v) : v_{v} {}
    operator vec3<T>() const { return v_; }  // NOLINT: as above

private:
    vec3<T> v_;
};

/// What is there or is not: asked, looked at, and no more. Neither default-constructible nor comparable.
template <typename V>
class maybe {
public:
    maybe(std::nullopt_t) {}                      // NOLINT: so that functions can return either
    maybe(V value) : value_{std::move(value)} {}  // NOLINT: as above
    explicit operator bool() const { return value_.has_value(); }
    const V& operator*() const { return *value_; }
    const V* operator->() const { return value_.operator->(); }

private:
    std::optional<V> value_{};
};

/// Numbers whose pairs are of their own kind. Neither copied nor assigned.
template <std::floating_point T>
class sampler {
public:
    struct pair {
        T x;
        T y;
        operator aglow::vec2<T>() const { return {x, y}; }  // NOLINT: hosts' vectors convert silently, as here
    };

    explicit sampler(std::uint64_t start) : random_{start} {}
    sampler(const sampler&) = delete;
    sampler& operator=(const sampler&) = delete;

    T next_1d() { return random_.next_1d(); }
    pair next_2d() {
        const T x = next_1d();
        return {x, next_1d()};
    }

private:
    aglow::random_sampler<T> random_;
};

/// The numbers of one path: copied, never assigned, never made of nothing.
template <std::floating_point T>
class numbers {
public:
    explicit numbers(const aglow::path_key& key) : key_{key} {}
    numbers& operator=(const numbers&) = delete;
    numbers(const numbers&) = default;

    [[nodiscard]] sampler<T> at(std::uint32_t bounce, aglow::purpose why) const {
        return sampler<T>{aglow::mix(key_, bounce, why)};
    }
    [[nodiscard]] numbers fork(std::uint64_t branch) const {
        return numbers{{key_.seed, aglow::mix(key_.pass, ~branch), key_.path}};
    }

private:
    const aglow::path_key key_;
};

/// A place with a normal, and nothing known of light.
template <std::floating_point T>
struct hit {
    point<T> position;
    direction<T> normal;
};

/// A matte surface of albedo 1/2 on the side of its normal, black on the other.
template <std::floating_point T>
class surface {
public:
    struct scattered {
        direction<T> wi;
        spectrum<T> weight;
        T pdf;
        lobe_set lobe;
    };

    point<T> position;
    direction<T> normal;

    [[nodiscard]] lobe_set lobes() const { return lobe_set::diffuse_reflection; }

    [[nodiscard]] spectrum<T> evaluate(const vec3<T>& wo, const vec3<T>& wi, lobe_set asked) const {
        return reflects(wo, asked) && cosine(wi) > 0 ? albedo() * (1 / aglow::pi<T>) : spectrum<T>{};
    }
    [[nodiscard]] T pdf(const vec3<T>& wo, const vec3<T>& wi, lobe_set asked) const {
        return reflects(wo, asked) ? aglow::cosine_hemisphere_pdf(cosine(wi)) : T(0);
    }
    template <aglow::Sampler R>
    [[nodiscard]] maybe<scattered> sample(const vec3<T>& wo, R& random, lobe_set asked) const {
        if (!reflects(wo, asked)) { return std::nullopt; }
        const auto u = random.next_2d();
        const vec3<T> local = aglow::cosine_hemisphere(aglow::vec2<T>{T(u.x), T(u.y)});
        const vec3<T> wi = aglow::frame<T>{vec3<T>(normal)}.to_world(local);
        return scattered{direction<T>{wi}, albedo(), aglow::cosine_hemisphere_pdf(local.z), lobes()};
    }

    static spectrum<T> albedo() { return spectrum<T>::of(T(0.5), T(0.5)); }

private:
    [[nodiscard]] T cosine(const vec3<T>& w) const { return glm::dot(vec3<T>(normal), w); }
    [[nodiscard]] bool reflects(const vec3<T>& wo, lobe_set asked) const {
        return any(asked, lobes()) && cosine(wo) > 0;
    }

public:
    surface(const vec3<T>& p, const vec3<T>& n) : position{p.x, p.y, p.z}, normal{n} {}
};

/// States its scalar only where it is not the library's default.
template <std::floating_point T>
struct states_scalar {
    using scalar = T;
};
template <>
struct states_scalar<float> {};

/// The inside of a unit sphere around the origin. Neither copied nor assigned; says nothing of lobes or bounds.
template <std::floating_point T>
class scene : public states_scalar<T> {
public:
    /// Tells yes from no, and is nothing else.
    class answer {
    public:
        explicit answer(bool yes) : yes_{yes} {}
        operator bool() const { return yes_; }  // NOLINT: a host's answer converts silently

    private:
        bool yes_;
    };

    scene() = default;
    scene(const scene&) = delete;
    scene& operator=(const scene&) = delete;

    [[nodiscard]] maybe<surface<T>> intersect(const aglow::ray<T>& r) const {
        // |o + t d| = 1: from inside the only root in front, from outside the nearer one.
        const T b = glm::dot(r.origin, r.direction);
        const T inside = 1 - aglow::length2(r.origin);
        const T root2 = b * b + inside;
        if (!(root2 > 0)) { return std::nullopt; }
        const T root = std::sqrt(root2);
        const T far = b <= 0 ? root - b : inside / (root + b);
        const T t = inside < 0 ? -b - root : far;
        if (!(t > 0) || !(t < r.reach)) { return std::nullopt; }
        const vec3<T> n = -glm::normalize(r.origin + r.direction * t);
        return surface<T>{-n, n};
    }

    /// The wall is between an inner and an outer point, and between outer ones whose segment meets the ball.
    [[nodiscard]] answer occluded(const vec3<T>& a, const vec3<T>& b) const {
        const bool a_inside = aglow::length2(a) <= 1;
        const bool b_inside = aglow::length2(b) <= 1;
        if (a_inside || b_inside) { return answer{a_inside != b_inside}; }
        const vec3<T> d = b - a;
        const T along = std::clamp(-glm::dot(a, d) / aglow::length2(d), T(0), T(1));
        return answer{aglow::length2(a + d * along) < 1};
    }
};

/// An isotropic point light at the origin that sends out particles.
template <std::floating_point T>
class emitter : public states_scalar<T> {
public:
    class flight {
    public:
        explicit flight(const vec3<T>& towards) : towards_{towards} {}
        operator aglow::ray<T>() const { return {vec3<T>{}, towards_}; }  // NOLINT: as above

    private:
        vec3<T> towards_;
    };
    struct particle {
        flight path;
        spectrum<T> power;
    };

    explicit emitter(const spectrum<T>& intensity) : intensity_{intensity} {}
    emitter(const emitter&) = delete;
    emitter& operator=(const emitter&) = delete;

    template <aglow::Sampler R>
    [[nodiscard]] particle emit(R& random) const {
        const auto u = random.next_2d();
        const vec3<T> towards = aglow::uniform_sphere(aglow::vec2<T>{T(u.x), T(u.y)});
        return {flight{towards}, intensity_ * (4 * aglow::pi<T>)};
    }

private:
    spectrum<T> intensity_;
};

/// The same light, looked at.
template <std::floating_point T>
class illuminator : public states_scalar<T> {
public:
    struct look {
        direction<T> towards;
        T distance;
        spectrum<T> radiance_over_pdf;
        T pdf;
    };

    explicit illuminator(const spectrum<T>& intensity) : intensity_{intensity} {}
    illuminator(const illuminator&) = delete;
    illuminator& operator=(const illuminator&) = delete;

    template <aglow::Sampler R>
    [[nodiscard]] maybe<look> illuminate(const vec3<T>& from, R&) const {
        const T distance2 = aglow::length2(from);
        if (!(distance2 > 0)) { return std::nullopt; }
        const T distance = std::sqrt(distance2);
        return look{direction<T>{from * (-1 / distance)}, distance, intensity_ * (1 / distance2), T(0)};
    }

private:
    spectrum<T> intensity_;
};

/// The same light, both ways: what integrators on photon maps ask.
template <std::floating_point T>
class lamp : public states_scalar<T> {
public:
    explicit lamp(const spectrum<T>& intensity) : sent_{intensity}, seen_{intensity} {}
    lamp(const lamp&) = delete;
    lamp& operator=(const lamp&) = delete;

    template <aglow::Sampler R>
    [[nodiscard]] typename emitter<T>::particle emit(R& random) const {
        return sent_.emit(random);
    }
    template <aglow::Sampler R>
    [[nodiscard]] maybe<typename illuminator<T>::look> illuminate(const vec3<T>& from, R& random) const {
        return seen_.illuminate(from, random);
    }

private:
    emitter<T> sent_;
    illuminator<T> seen_;
};

/// Runs the tasks on the calling thread, the last one first. Neither copied nor assigned.
struct executor {
    executor() = default;
    executor(const executor&) = delete;
    executor& operator=(const executor&) = delete;

    template <typename Task>
    void operator()(std::size_t count, Task&& task) const {
        while (count > 0) { task(--count); }
    }
};

}  // namespace archetypes
