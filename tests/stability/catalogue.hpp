// The stiff and extreme cases as data: what to build, what to measure, what must come out, and how near. Depends on the
// standard library alone, so that any renderer can be held to it; README.md says how.
#pragma once

#include <array>
#include <limits>
#include <string_view>
#include <vector>

#include "stability/closed_forms.hpp"

namespace stability {

/// How near is near enough.
enum class nearness {
    exact,     ///< the same bits
    ulp,       ///< |x - expected| <= tolerance eps |expected|
    sigmas,    ///< Monte Carlo: within `tolerance` standard errors of the mean
    reported,  ///< biased: within the error that the integrator itself reports
    status     ///< a refusal, a flag or a count, and finite numbers
};

/// One row.
struct stiff_case {
    int number;
    std::string_view scene;
    std::string_view quantity;
    std::string_view expected;
    nearness how;
    double tolerance;
};

inline constexpr std::array<stiff_case, 80> catalogue{{
    {1, "closed room, Le = 1, rho = 0, .5, .9, .99, .999999", "L", "1 / (1 - rho); rho = 0 exact", nearness::sigmas, 4},
    {2, "the same, rho = 1", "status", "not dissipative; ends", nearness::status, 0},
    {3, "the same, rho > 1, rho < 0, NaN", "status", "told or dropped", nearness::status, 0},
    {4, "unit sphere, bulb of pi W/sr at its centre, rho = .5", "L", "1", nearness::sigmas, 4},
    {5, "matte sphere, bulb anywhere", "indirect E", "P rho / (4 pi R2 (1 - rho))", nearness::sigmas, 4},
    {6, "integrating sphere with a port f", "L", "P / (pi A) rho / (1 - rho (1 - f))", nearness::sigmas, 4},
    {7, "two plates within mirrors", "B", "(E1 + rho1 E2) / (1 - rho1 rho2)", nearness::sigmas, 4},
    {8, "the same, rho = .999999", "B", "1e6", nearness::sigmas, 4},
    {9, "concentric spheres", "B1, B2", "two equations with F21 = (r1/r2)2", nearness::sigmas, 4},
    {10, "coaxial cylinders, mirror ends", "B1, B2", "two equations with F21 = r1/r2", nearness::sigmas, 4},
    {11, "dome and floor", "B1, B2", "two equations with F21 = 1/2", nearness::sigmas, 4},
    {12, "kissing spheres, port f", "B_A, B_B", "k = rho f / (1 - rho (1 - f))", nearness::sigmas, 4},
    {13, "the same, f = 1e-6", "B_B / B_A", "9.0e-6 (rho .9), .5 (rho .999999)", nearness::sigmas, 4},
    {14, "50 diffuse sheets, R = T = .5", "T", "1/51; arrivals fall evenly", nearness::sigmas, 4},
    {15, "100 glass surfaces, n = 1.5, straight on", "T", ".1935484; R + T = 1", nearness::sigmas, 4},
    {16, "glass slab beyond the critical angle", "loss after 100 bounces", "0", nearness::exact, 0},
    {17, "glass balls in an even sky", "L", "1", nearness::sigmas, 4},
    {18, "equal indices", "Fresnel, direction", "0, straight on", nearness::exact, 0},
    {19, "rough mirror, roughness 1e-6 .. 1", "albedo", "<= 1, finite", nearness::status, 0},
    {20, "nothing, even sky", "E", "pi L", nearness::ulp, 16},
    {21, "mirror and matte room without loss, one black patch", "particles at the patch", "all", nearness::exact, 0},
    {22, "parallel unit squares, d = 1", "F", "0.19982489569838746", nearness::sigmas, 4},
    {23, "perpendicular unit squares", "F", "0.20004377607540316", nearness::sigmas, 4},
    {24, "coaxial discs 1, 1, 1 and 1, 2, 1", "F", ".3819660112501051, .7639320225002102", nearness::sigmas, 4},
    {25, "under a disc", "E", "pi L R2 / (R2 + h2)", nearness::sigmas, 4},
    {26, "ball above the horizon", "E", "pi L (R/d)2 cos", nearness::sigmas, 4},
    {27, "polygon, h = 1e-6 .. 1e8, clipped", "E", "Lambert, long double", nearness::ulp, 16},
    {28, "half-plane, corner, even sky", "E / open", "1/2, 1/4", nearness::sigmas, 4},
    {29, "bulb at 1e-2, 1e-8, 1e-20", "E", "1/d2, or black; never infinite", nearness::status, 0},
    {30, "bulb at cosine 1e-7, 0, -1e-9", "E", ">= 0; below: 0 exact", nearness::exact, 0},
    {31, "needle triangle, aspect 1e8", "E", "analytic; uniform samples", nearness::ulp, 16},
    {32, "light without area", "E", "0", nearness::exact, 0},
    {33, "CIE 171 5.6 to 5.14, own references", "E", "form factors; P rho / (S (1 - rho))", nearness::sigmas, 4},
    {34, "ellipsoid mirror, bulb in a focus", "path length, flux", "2a; rho P at every radius", nearness::ulp, 64},
    {35, "paraboloid", "directions, density", "parallel; I / (F + s2/4F)2", nearness::sigmas, 4},
    {36, "fold caustic", "error of radius r", "r^(1/2), within the reported error", nearness::reported, 1},
    {37, "1e6 photons in one point", "E pi r2", "their power", nearness::ulp, 1e4},
    {38, "lattice", "k nearest", "brute force by (distance, index)", nearness::exact, 0},
    {39, "even density, k nearest", "mean, variance", "f, f2 / (k - 2)", nearness::sigmas, 4},
    {40, "border at t radii", "E / open", "1 - (acos t - t sqrt(1 - t2)) / pi", nearness::ulp, 1e14},
    {41, "kernels", "mass, second moment", "1; r2 lap/12, r2 lap/8", nearness::ulp, 1e4},
    {42, "any room", "particles", "emitted = sum of all ends", nearness::exact, 0},
    {43, "geometry times 2^k, k = -30 .. 30", "picture", "the same", nearness::exact, 0},
    {44, "emission times 2^k, k = -60 .. 60", "picture", "times 2^k", nearness::exact, 0},
    {45, "geometry times 1e-12 .. 1e12", "picture", "the same", nearness::ulp, 1e4},
    {46, "moved by 2^20 on a grid of 2^-10", "E", "8 ulp(2^20) / feature", nearness::ulp, 2e6},
    {47, "moved by 1e6", "L", "ulp(1e6) / feature; loss told", nearness::status, 0},
    {48, "bands permuted", "picture", "permuted", nearness::exact, 0},
    {49, "gray in RGB and in one band", "L", "the same", nearness::exact, 0},
    {50, "two lights and each alone", "fluence", "the sum", nearness::sigmas, 4},
    {51, "a light cut in two", "fluence", "the same", nearness::sigmas, 4},
    {52, "light and sensor swapped", "fluence", "the same", nearness::sigmas, 4},
    {53, "turned by 90 degrees", "fluence", "the same", nearness::sigmas, 4},
    {54, "a wall that is there twice", "picture", "the same", nearness::exact, 0},
    {55, "a far black ball", "picture", "the same", nearness::exact, 0},
    {56, "any room", "L", "0 <= L <= Le / (1 - rho)", nearness::sigmas, 4},
    {57, "records and spheres of reach 0, inf, NaN, < 0", "status", "refused, counted", nearness::status, 0},
    {58, "query at a record, at two", "E", "the record's; their mean", nearness::ulp, 8},
    {59, "crevice", "records", "<= A / (pi (R_min / 2)2)", nearness::status, 0},
    {60, "normals with n.n > 1", "look-up", "finite", nearness::status, 0},
    {61, "points on plane, line, spot", "k nearest", "brute force", nearness::exact, 0},
    {62, "k > N, N = 0, empty map and cache", "answer", "0 or none", nearness::status, 0},
    {63, "coordinates 1e12, reach 1e-6", "finds", "brute force", nearness::exact, 0},
    {64, "powers 1e-30 beside 1", "E of each region", "1 %", nearness::status, 0.01},
    {65, "powers of 1e-42", "E", "as without scaling", nearness::ulp, 4},
    {66, "radical inverse, last indices, 1000 primes", "number", "in [0, 1)", nearness::exact, 0},
    {67, "dimensions beyond the table", "number", "hashed; told", nearness::status, 0},
    {68, "u = 0, 1 - eps in every warp", "direction, pdf", "unit, > 0", nearness::ulp, 4},
    {69, "float and double", "picture", "alike", nearness::sigmas, 4},
    {70, "-ffast-math", "this suite", "passes", nearness::status, 0},
    {71, "flush to zero", "picture", "the same", nearness::ulp, 4},
    {72, "1, 2, 3, 5, 8, 16 threads", "picture", "the same", nearness::exact, 0},
    {73, "1e7 passes", "radius", "closed form", nearness::ulp, 5e9},
    {74, "mean 1e6, deviation 1", "variance", "1", nearness::sigmas, 4},
    {75, "1e8 photons", "sum of powers", "1e-6", nearness::ulp, 1e10},
    {76, "no light, black walls", "everything", "0; nothing stored", nearness::exact, 0},
    {77, "eye in a wall, picture 1 x 1 and 0 x 0", "status", "finite", nearness::status, 0},
    {78, "host returning what cannot be", "counts, light lost", "by kind", nearness::status, 0},
    {79, "absorption, d = 1e-12 .. 1e4", "T", "exp(-s d)", nearness::ulp, 8},
    {80, "wall of 1e-3, radius .1", "leak", "falls with r; told", nearness::reported, 1},
}};

/// A number to be measured, for rows whose scene is given by a few numbers.
struct measured_case {
    int row;
    std::string_view what;  ///< the numbers, by the names used in the catalogue
    double expected;
};

/// What closed forms say, ready to compare with.
[[nodiscard]] inline std::vector<measured_case> measured_cases() {
    return {{1, "L, rho = .5", furnace(0.5)},
            {1, "L, rho = .9", furnace(0.9)},
            {1, "L, rho = .99", furnace(0.99)},
            {1, "L, rho = .999999", furnace(0.999999)},
            {5, "indirect E, P = 4 pi, rho = .5, R = 2", sphere_indirect(4 * pi, 0.5, 2)},
            {6, "L, P = 4 pi, rho = .9, R = 1, f = .1", integrating_sphere(4 * pi, 0.9, 1, 0.1)},
            {7, "B1, E = 1, .25, rho = .5, .8", enclosure(1, 0.5, 0.25, 0.8, 1).first},
            {8, "B, E = 1, rho = .999999", enclosure(1, 0.999999, 1, 0.999999, 1).first},
            {9, "B1, E = 1, .1, rho = .6, .7, r1/r2 = .5", enclosure(1, 0.6, 0.1, 0.7, 0.25).first},
            {9, "B2 of the same", enclosure(1, 0.6, 0.1, 0.7, 0.25).second},
            {10, "B1 of the same", enclosure(1, 0.6, 0.1, 0.7, 0.5).first},
            {11, "B2 of the same", enclosure(1, 0.6, 0.1, 0.7, 0.5).second},
            {12, "B_A, rho = .9, f = .01", kissing_spheres(0.9, 0.01).first},
            {12, "B_B, rho = .9, f = .01", kissing_spheres(0.9, 0.01).second},
            {13, "B_B / B_A, rho = .9", kissing_spheres(0.9, 1e-6).second / kissing_spheres(0.9, 1e-6).first},
            {14, "T", stack_transmittance(0.5, 50)},
            {15, "T", stack_transmittance(normal_reflectance(1.5), 100)},
            {20, "E, L = 1", pi},
            {22, "F", parallel_squares(1)},
            {23, "F", perpendicular_squares()},
            {24, "F, 1, 1, 1", coaxial_discs(1, 1, 1)},
            {24, "F, 1, 2, 1", coaxial_discs(1, 2, 1)},
            {25, "E, R = 1, h = 1", under_disc(1, 1)},
            {28, "E / open, half-plane", 0.5},
            {35, "flux within s = 2, F = .5, I = 1", paraboloid_flux(0.5, 2)},
            {40, "E / open, t = .5", share_at_border(0.5)}};
}

/// Holds `x`, measured with standard error `error` (0 where there is none), to a row; `rounding` is an ulp of 1.
[[nodiscard]] inline bool holds(const stiff_case& row, double x, double expected, double error,
                                double rounding = std::numeric_limits<double>::epsilon()) {
    const double off = x > expected ? x - expected : expected - x;
    const double size = expected < 0 ? -expected : expected;
    switch (row.how) {
        case nearness::exact: return off == 0;
        case nearness::ulp: return off <= row.tolerance * rounding * size;
        case nearness::sigmas: return off <= row.tolerance * error + 16 * rounding * size;
        case nearness::reported: return off <= row.tolerance * error;
        case nearness::status: break;
    }
    return off <= std::numeric_limits<double>::max();
}

}  // namespace stability
