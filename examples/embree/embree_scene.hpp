// Embree as an aglow scene: copy this page into a renderer that traces with Embree 3 or 4.
//
// Give it triangles and one function that makes your own hit of what Embree found; the rest of aglow then asks this
// class.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <aglow/concepts/intersector.hpp>

namespace host {

/// What Embree found, in scene units.
struct embree_hit {
    aglow::vec3<float> position{};
    aglow::vec3<float> normal{};  ///< unit, geometric: the side from which the corners turn left
    float position_error{};       ///< how far `position` may lie from the triangle
    float distance{};
    std::uint32_t mesh{};            ///< as `add_mesh` numbered it
    std::uint32_t triangle{};        ///< within the mesh
    float u{};                       ///< weight of the second corner
    float v{};                       ///< weight of the third
    aglow::vec3<float> direction{};  ///< of the ray
};

/// The library's `Intersector`, and its `Scene` where `Shade` makes surfaces. `shade(const embree_hit&)` turns what was
/// found into the host's hit and is called from many threads. Meshes first, then `commit()`, then rays.
template <typename Shade>
    requires aglow::Hit<std::invoke_result_t<const Shade&, const embree_hit&>>
class embree_scene {
public:
    using scalar = float;
    using hit_type = std::invoke_result_t<const Shade&, const embree_hit&>;

    /// Throws `std::runtime_error` where Embree cannot start.
    explicit embree_scene(Shade shade)
        : shade_{std::move(shade)},
          device_{rtcNewDevice(nullptr)},
          scene_{device_ ? rtcNewScene(device_.get()) : nullptr} {
        if (!scene_) {
            throw std::runtime_error("Embree does not start: error " + std::to_string(rtcGetDeviceError(nullptr)));
        }
        // Without it rays slip through between neighbouring triangles.
        rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    }

    /// Copies a mesh; returns its number. Throws `std::runtime_error` where memory ends.
    std::uint32_t add_mesh(std::span<const aglow::vec3<float>> corners,
                           std::span<const std::array<std::uint32_t, 3>> triangles) {
        const handle<RTCGeometry, rtcReleaseGeometry> mesh{rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE)};
        auto* to = static_cast<aglow::vec3<float>*>(rtcSetNewGeometryBuffer(
            mesh.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(aglow::vec3<float>), corners.size()));
        auto* index = static_cast<std::array<std::uint32_t, 3>*>(
            rtcSetNewGeometryBuffer(mesh.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                    sizeof(std::array<std::uint32_t, 3>), triangles.size()));
        if (!to || !index) { throw std::runtime_error("Embree has no memory for a mesh"); }
        std::copy(corners.begin(), corners.end(), to);
        std::copy(triangles.begin(), triangles.end(), index);
        rtcCommitGeometry(mesh.get());
        for (const aglow::vec3<float>& p : corners) { bounds_.add(p); }
        return rtcAttachGeometry(scene_.get(), mesh.get());
    }

    /// Builds the tree. To be called once, after the last mesh.
    void commit() {
        rtcCommitScene(scene_.get());
        error_ = bounds_.empty()
                     ? 0
                     : aglow::position_error(std::max(aglow::max_abs(bounds_.low), aglow::max_abs(bounds_.high)));
    }

    [[nodiscard]] std::optional<hit_type> intersect(const aglow::ray<float>& r) const {
        RTCRayHit q{};
        q.ray = embree_ray(r.origin, r.direction, r.reach);
        q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
        rtcIntersect1(scene_.get(), &q);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene_.get(), &context, &q);
#endif
        if (q.hit.geomID == RTC_INVALID_GEOMETRY_ID) { return std::nullopt; }
        const aglow::vec3<float> normal = glm::normalize(aglow::vec3<float>{q.hit.Ng_x, q.hit.Ng_y, q.hit.Ng_z});
        return shade_(embree_hit{position(q.hit), normal, error_, q.ray.tfar, q.hit.geomID, q.hit.primID, q.hit.u,
                                 q.hit.v, r.direction});
    }

    [[nodiscard]] bool occluded(const aglow::vec3<float>& a, const aglow::vec3<float>& b) const {
        // Always from the same end, so that rounding is the same both ways.
        const bool swap = b.x != a.x ? b.x < a.x : b.y != a.y ? b.y < a.y : b.z < a.z;
        RTCRay r = swap ? embree_ray(b, a - b, 1) : embree_ray(a, b - a, 1);
#if RTC_VERSION_MAJOR >= 4
        rtcOccluded1(scene_.get(), &r);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcOccluded1(scene_.get(), &context, &r);
#endif
        return r.tfar < 0;
    }

    [[nodiscard]] const aglow::bounds<float>& bounds() const { return bounds_; }
    [[nodiscard]] float position_error() const { return error_; }
    [[nodiscard]] const Shade& shade() const { return shade_; }

private:
    /// Owns one of Embree's reference-counted things.
    template <typename Thing, void (*Release)(Thing)>
    struct releaser {
        using pointer = Thing;
        void operator()(Thing thing) const { Release(thing); }
    };
    template <typename Thing, void (*Release)(Thing)>
    using handle = std::unique_ptr<std::remove_pointer_t<Thing>, releaser<Thing, Release>>;

    static RTCRay embree_ray(const aglow::vec3<float>& o, const aglow::vec3<float>& d, float reach) {
        RTCRay r{};
        r.org_x = o.x;
        r.org_y = o.y;
        r.org_z = o.z;
        r.dir_x = d.x;
        r.dir_y = d.y;
        r.dir_z = d.z;
        r.tnear = 0;
        r.tfar = reach;
        r.mask = 0xffffffffu;
        return r;
    }

    /// From the corners: closer to the triangle than origin + t direction is.
    [[nodiscard]] aglow::vec3<float> position(const RTCHit& h) const {
        const RTCGeometry mesh = rtcGetGeometry(scene_.get(), h.geomID);
        const auto* corners =
            static_cast<const aglow::vec3<float>*>(rtcGetGeometryBufferData(mesh, RTC_BUFFER_TYPE_VERTEX, 0));
        const auto& i = static_cast<const std::array<std::uint32_t, 3>*>(
            rtcGetGeometryBufferData(mesh, RTC_BUFFER_TYPE_INDEX, 0))[h.primID];
        return corners[i[0]] * (1 - h.u - h.v) + corners[i[1]] * h.u + corners[i[2]] * h.v;
    }

    Shade shade_;
    handle<RTCDevice, rtcReleaseDevice> device_;
    handle<RTCScene, rtcReleaseScene> scene_;
    aglow::bounds<float> bounds_{};
    float error_{0};
};

}  // namespace host
