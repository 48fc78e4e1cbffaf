// How fast the gradient of irradiance changes, occlusion included: what says how far one record may reach.
//
// Samples become the corners of a mesh that looks like the scene from here; each triangle has the radiance of its
// farthest corner, because that is what comes to light when the point moves (Schwarzhaupt et al. 2012, Practical
// Hessian-Based Error Control). The edges' derivatives are summed in angular form, tabulated for a polar grid:
// quadratic in the two reciprocal distances, and the same for every sector but for a rotation.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/edge_derivatives.hpp>
#include <aglow/estimators/hemisphere.hpp>

namespace aglow {

/// The two curvatures of a symmetric tangent matrix: eigenvalues, the one of larger magnitude first, and its direction.
template <std::floating_point T>
struct principal_curvatures {
    T major{};
    T minor{};
    vec2<T> axis{1, 0};  ///< unit direction of `major`; any where the two are equal
};

/// Closed form without thresholds: any scale, any ratio.
template <std::floating_point T>
[[nodiscard]] principal_curvatures<T> principal(const tangent_matrix<T>& h) {
    const T mean = (h.xx + h.yy) / 2;
    const T difference = (h.xx - h.yy) / 2;
    const T radius = std::hypot(difference, h.xy);
    const T sign = mean < 0 ? T(-1) : T(1);
    principal_curvatures<T> result{mean + sign * radius, mean - sign * radius, {1, 0}};
    if (radius > 0) {
        const T angle = std::atan2(sign * h.xy, sign * difference) / 2;
        result.axis = {std::cos(angle), std::sin(angle)};
    }
    return result;
}

/// The tabulated edges of the mesh over one shape of hemisphere; made once (some 100 us), used for many.
template <std::floating_point T>
class hessian_weights {
public:
    explicit hessian_weights(const hemisphere_shape& shape) : shape_{shape} {
        const double step = 2 * pi<double> / shape.sectors;
        for (std::uint32_t j = 0; j <= shape.rings; ++j) {
            const bool last = j == shape.rings;
            rows_.push_back({tabulate(corner(j, 0), corner(j, step)),
                             last ? edge{} : tabulate(corner(j, 0), corner(j + 1, 0)),
                             last ? edge{} : tabulate(corner(j, 0), corner(j + 1, step))});
        }
        for (std::uint32_t k = 0; k < shape.sectors; ++k) {
            const double angle = 2 * step * (k + 0.5);
            turns_.push_back({static_cast<T>(std::cos(angle)), static_cast<T>(std::sin(angle))});
        }
    }

    /// One edge's second derivatives as trace / 2, (xx - yy) / 2 and xy, each a polynomial in u0², u0 u1, u1².
    struct edge {
        std::array<T, 3> mean{};
        std::array<T, 3> difference{};
        std::array<T, 3> mixed{};
    };
    /// The edges that begin at a corner of row `j`: along the ring, outwards, and outwards to the next sector. Row 0 is
    /// the zenith, row j + 1 is ring j.
    struct row {
        edge along;
        edge out;
        edge diagonal;
    };

    [[nodiscard]] const hemisphere_shape& shape() const { return shape_; }
    [[nodiscard]] const std::vector<row>& rows() const { return rows_; }

    /// Cosine and sine of twice the azimuth of each sector's middle: how its tangent matrices turn.
    [[nodiscard]] const std::vector<vec2<T>>& turns() const { return turns_; }

private:
    [[nodiscard]] vec3<double> corner(std::uint32_t j, double angle) const {
        if (j == 0) { return {0, 0, 1}; }
        const double sine2 = (j - 0.5) / shape_.rings;
        const double sine = std::sqrt(sine2);
        return {sine * std::cos(angle), sine * std::sin(angle), std::sqrt(1 - sine2)};
    }

    static edge tabulate(const vec3<double>& d0, const vec3<double>& d1) {
        const tangent_matrix<double> first = edge_hessian<double>({d0, d1, 1, 0});
        const tangent_matrix<double> second = edge_hessian<double>({d0, d1, 0, 1});
        const tangent_matrix<double> both = edge_hessian<double>({d0, d1, 1, 1});
        const tangent_matrix<double> cross = both + (first + second) * -1.0;
        edge result;
        const std::array<tangent_matrix<double>, 3> all{first, cross, second};
        for (std::size_t i = 0; i < 3; ++i) {
            result.mean[i] = static_cast<T>((all[i].xx + all[i].yy) / 2);
            result.difference[i] = static_cast<T>((all[i].xx - all[i].yy) / 2);
            result.mixed[i] = static_cast<T>(all[i].xy);
        }
        return result;
    }

    hemisphere_shape shape_;
    std::vector<row> rows_;
    std::vector<vec2<T>> turns_;
};

/// The mesh's memory between calls, so that a thread that makes many records allocates once.
template <std::floating_point T>
struct hessian_scratch {
    std::vector<T> value;  ///< sector by sector, each from the zenith outwards
    std::vector<T> inverse_distance;
    std::vector<T> triangles;
};

namespace detail {

/// Mean, half difference and mixed part of a tangent matrix, as sums.
template <std::floating_point T>
struct hessian_sum {
    T mean{};
    T difference{};
    T mixed{};

    void add(const typename hessian_weights<T>::edge& e, T u0, T u1, T step) {
        const T a = u0 * u0 * step;
        const T b = u0 * u1 * step;
        const T c = u1 * u1 * step;
        mean += e.mean[0] * a + e.mean[1] * b + e.mean[2] * c;
        difference += e.difference[0] * a + e.difference[1] * b + e.difference[2] * c;
        mixed += e.mixed[0] * a + e.mixed[1] * b + e.mixed[2] * c;
    }
};

/// The value of the farthest of three corners: what comes to light when the nearer ones move.
template <typename T>
[[nodiscard]] T farthest(T u0, T v0, T u1, T v1, T u2, T v2) {
    const bool first = u0 <= u1;
    const T u = first ? u0 : u1;
    const T v = first ? v0 : v1;
    return u <= u2 ? v : v2;
}

/// Values normalised to mean 1 with one percent of "black occluders", and reciprocal distances, by columns that start
/// at the zenith. Black everywhere: 1 everywhere, so that geometry alone decides.
template <Spectrum S, std::floating_point T>
void fill_mesh(const hemisphere_grid<S, T>& grid, hessian_scratch<T>& mesh) {
    const auto [rings, sectors] = grid.shape();
    const std::size_t height = std::size_t{rings} + 1;
    mesh.value.resize(height * sectors);
    mesh.inverse_distance.resize(height * sectors);
    const S* l = grid.radiance().data();
    const T* u = grid.inverse_distance().data();
    T sum{};
    T zenith_value{};
    T zenith_distance{};
    for (std::uint32_t k = 0; k < sectors; ++k) {
        for (std::uint32_t j = 0; j < rings; ++j, ++l, ++u) {
            const std::size_t at = k * height + j + 1;
            mesh.value[at] = static_cast<T>(max_component(*l));
            mesh.inverse_distance[at] = *u;
            sum += mesh.value[at];
        }
        zenith_value += mesh.value[k * height + 1];
        zenith_distance += mesh.inverse_distance[k * height + 1];
    }
    for (std::uint32_t k = 0; k < sectors; ++k) {
        mesh.value[k * height] = zenith_value / static_cast<T>(sectors);
        mesh.inverse_distance[k * height] = zenith_distance / static_cast<T>(sectors);
    }
    const T scale = sum > 0 ? T(0.99) * static_cast<T>(grid.shape().count()) / sum : T(0);
    const T base = scale > 0 ? T(0.01) : T(1);
    for (T& v : mesh.value) { v = v * scale + base; }
}

/// The radiance of the two triangles of every quad of the mesh.
template <std::floating_point T>
void fill_triangles(const hemisphere_shape& shape, hessian_scratch<T>& mesh) {
    const std::size_t height = std::size_t{shape.rings} + 1;
    mesh.triangles.resize(2 * std::size_t{shape.rings} * shape.sectors);
    T* out = mesh.triangles.data();
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        const std::size_t next = k + 1 == shape.sectors ? 0 : k + 1;
        const T* u = &mesh.inverse_distance[k * height];
        const T* v = &mesh.value[k * height];
        const T* u_next = &mesh.inverse_distance[next * height];
        const T* v_next = &mesh.value[next * height];
        for (std::uint32_t j = 0; j < shape.rings; ++j) {
            *out++ = farthest(u[j], v[j], u[j + 1], v[j + 1], u_next[j + 1], v_next[j + 1]);
            *out++ = farthest(u[j], v[j], u_next[j], v_next[j], u_next[j + 1], v_next[j + 1]);
        }
    }
}

/// All edges that begin in one column. An edge counts by the step of radiance across it; the rim of the mesh is none.
template <std::floating_point T>
[[nodiscard]] hessian_sum<T> sum_column(const std::vector<typename hessian_weights<T>::row>& rows, const T* u,
                                        const T* u_next, const T* here, const T* before) {
    hessian_sum<T> sum;
    const std::size_t rings = rows.size() - 1;
    for (std::size_t j = 0; j < rings; ++j) {
        const T inner = here[2 * j];
        const T outer = here[2 * j + 1];
        sum.add(rows[j].out, u[j], u[j + 1], inner - before[2 * j + 1]);
        sum.add(rows[j].diagonal, u[j], u_next[j + 1], outer - inner);
        if (j > 0) { sum.add(rows[j].along, u[j], u_next[j], here[2 * j - 2] - outer); }
    }
    return sum;
}

}  // namespace detail

/// Second derivatives of irradiance over irradiance, in local axes, per length²; of the largest band, with occlusion
/// and with one percent of imagined black occluders. Expects weights of the grid's shape.
template <Spectrum S, std::floating_point T>
[[nodiscard]] tangent_matrix<T> relative_hessian(const hemisphere_grid<S, T>& grid, const hessian_weights<T>& weights,
                                                 hessian_scratch<T>& mesh) {
    const auto [rings, sectors] = grid.shape();
    const std::size_t height = std::size_t{rings} + 1;
    detail::fill_mesh(grid, mesh);
    detail::fill_triangles(grid.shape(), mesh);
    const T* triangles = mesh.triangles.data();
    const T* before = triangles + 2 * std::size_t{rings} * (sectors - 1);
    tangent_matrix<T> total;
    for (std::uint32_t k = 0; k < sectors; ++k) {
        const T* here = triangles + 2 * std::size_t{rings} * k;
        const T* u = &mesh.inverse_distance[k * height];
        const T* u_next = &mesh.inverse_distance[(k + 1 == sectors ? 0 : k + 1) * height];
        const detail::hessian_sum<T> s = detail::sum_column(weights.rows(), u, u_next, here, before);
        const vec2<T> turn = weights.turns()[k];
        const T difference = s.difference * turn.x - s.mixed * turn.y;
        const T mixed = s.difference * turn.y + s.mixed * turn.x;
        total = total + tangent_matrix<T>{s.mean + difference, mixed, s.mean - difference};
        before = here;
    }
    return total;
}

template <Spectrum S, std::floating_point T>
[[nodiscard]] tangent_matrix<T> relative_hessian(const hemisphere_grid<S, T>& grid, const hessian_weights<T>& weights) {
    hessian_scratch<T> mesh;
    return relative_hessian(grid, weights, mesh);
}

}  // namespace aglow
