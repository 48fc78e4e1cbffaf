// A scene that counts the rays that it is asked.
#pragma once

#include <atomic>
#include <cstdint>

#include <aglow/core/ray.hpp>

namespace host {

/// Rays of the whole program. Each thread counts for itself and adds up when it ends, so that counting costs next to
/// nothing.
class ray_count {
public:
    std::uint64_t nearest{0};
    std::uint64_t shadow{0};

    ~ray_count() { flush(); }

    [[nodiscard]] static ray_count& here() {
        thread_local ray_count mine;
        return mine;
    }

    /// Of all threads that have ended, and of the caller.
    [[nodiscard]] static std::uint64_t all_nearest() {
        here().flush();
        return total_nearest;
    }
    [[nodiscard]] static std::uint64_t all_shadow() {
        here().flush();
        return total_shadow;
    }

private:
    void flush() {
        total_nearest += nearest;
        total_shadow += shadow;
        nearest = shadow = 0;
    }
    static inline std::atomic<std::uint64_t> total_nearest{0};
    static inline std::atomic<std::uint64_t> total_shadow{0};
};

/// `Scene`, all the same but for the counting.
template <typename Scene>
class counted_scene : public Scene {
public:
    using Scene::Scene;
    explicit counted_scene(Scene&& scene) : Scene{std::move(scene)} {}

    [[nodiscard]] auto intersect(const aglow::ray<typename Scene::scalar>& r) const {
        ++ray_count::here().nearest;
        return Scene::intersect(r);
    }
    [[nodiscard]] bool occluded(const aglow::vec3<typename Scene::scalar>& a,
                                const aglow::vec3<typename Scene::scalar>& b) const {
        ++ray_count::here().shadow;
        return Scene::occluded(a, b);
    }
};

}  // namespace host
