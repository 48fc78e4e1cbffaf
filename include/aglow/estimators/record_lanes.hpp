// Eight records of gray or RGB light side by side, so that a blend weighs them all at once.
//
// What `look`, `record_weight` and `compact_gradients` say of one record, in vectors of eight.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include <aglow/core/simd_eight.hpp>
#include <aglow/core/stereographic.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/compact_gradients.hpp>
#include <aglow/estimators/irradiance_record.hpp>
#include <aglow/estimators/record_view.hpp>

namespace aglow::detail {

/// Whether records of such light have a place in lanes.
template <typename S, typename T>
inline constexpr bool has_lanes = std::same_as<T, float>&& packed_bands<S> > 0;

/// What a blend sums up. The sums over eight records have a fixed order.
template <std::size_t Bands>
struct lane_sums {
    std::array<float, Bands + 2> parts{};  ///< light by band, weight, error
    double variance{};                     ///< squares of faint light leave the range of floats
    std::uint32_t records{0};
};

/// The sums of lanes for such light; `Without` where it has no lanes.
template <typename S, typename T, typename Without>
using lanes_or = std::conditional_t<has_lanes<S, T>, lane_sums<packed_bands<S> == 0 ? 1 : packed_bands<S>>, Without>;

template <typename S>
[[nodiscard]] S light_of(const lane_sums<packed_bands<S>>& sums) {
    if constexpr (packed_bands<S> == 1) {
        return sums.parts[0];
    } else {
        return {sums.parts[0], sums.parts[1], sums.parts[2]};
    }
}

/// Where a record keeps its parts, in words of 32 bits.
template <std::size_t Bands, record_features F>
struct record_words {
    static constexpr std::size_t position = 0;
    static constexpr std::size_t light = 3;
    static constexpr std::size_t radius = light + Bands;
    static constexpr std::size_t normal = radius + 1;
    static constexpr std::size_t ellipse = normal + 1;
    static constexpr std::size_t noise = ellipse + F.ellipse;
    static constexpr std::size_t slopes = noise + F.noise;
    static constexpr std::size_t count = slopes + (F.gradients ? 2 * Bands : 0);
};

/// What one is in a half of a word: see `words::first_half`.
inline constexpr float half_unit = 0x1p-16f;

/// Three vectors of `V`: a point or a direction in each lane.
template <typename V>
struct lane_points {
    V x, y, z;

    [[gnu::always_inline]] static lane_points all(const vec3<float>& p) {
        return {V::all(p.x), V::all(p.y), V::all(p.z)};
    }
    [[gnu::always_inline]] static lane_points difference(const lane_points& a, const lane_points& b) {
        return {a.x - b.x, a.y - b.y, a.z - b.z};
    }
    [[gnu::always_inline]] static V dot(const lane_points& a, const lane_points& b) {
        return a.x * b.x + a.y * b.y + a.z * b.z;
    }
};

/// `tilt` in lanes.
template <typename V>
struct lane_tilts {
    lane_points<V> normal;
    V side, a;

    /// Of a `stereographic`'s codes.
    [[gnu::always_inline]] static lane_tilts of(const typename V::words& codes) {
        using words = typename V::words;
        const words first = words::first_half(codes), second = words::last_half(codes);
        const V one = V::all(1), zero = V::all(0), half = V::all(0.5f);
        const V u = V::of(first) * V::all(stereographic::step_x<float> * half_unit);
        const V v = V::of(second & words::all(-0x20000)) * V::all(stereographic::step_y<float> * half_unit / 2);
        const V side = one - V::of(second & words::all(0x10000)) * V::all(2 * half_unit);
        const V middle = (one + u * u + v * v) * half;
        const V scale = one / middle;
        return {{u * scale, v * scale, side * V::max(scale - one, zero)}, side, zero - side * V::min(middle, one)};
    }
    [[gnu::always_inline]] lane_points<V> to_local(const lane_points<V>& v) const {
        const V along = normal.x * v.x + normal.y * v.y;
        const V lean = a * along - v.z;
        return {v.x + side * (normal.x * lean), side * v.y + normal.y * lean, along + normal.z * v.z};
    }
};

/// What records side by side say of points: each lane has a record and a point of its own.
template <typename S, record_features F>
class lane_records {
public:
    static constexpr std::size_t bands = packed_bands<S>;
    using record = irradiance_record<S, float, F>;
    using at = record_words<bands, F>;

    /// What each adds to its blend where it is `used`; elsewhere it means nothing.
    template <typename V>
    struct addends {
        typename V::words judged, used;
        V parts[bands + 2];  ///< as of `lane_sums`
        V noise;             ///< whose squares are the variance
    };

    /// The records' words. Expects good addresses in all lanes.
    template <typename Words>
    [[gnu::always_inline]] static void read(const char* const* records, Words (&words)[at::count]) {
        static_assert(std::is_trivially_copyable_v<record> && std::is_standard_layout_v<record>);
        static_assert(F.incident || sizeof(record) == sizeof(std::int32_t) * at::count);
        constexpr std::size_t some = Words::together;
        read(records, words, std::make_index_sequence<at::count / some>{});
        for (std::size_t w = at::count / some * some; w < at::count; ++w) {
            words[w] = Words::column(records, w * sizeof(std::int32_t));
        }
    }

    /// `bends` as of `record_blend::add`; the normals are unit.
    template <typename V, typename Words>
    [[gnu::always_inline]] static addends<V> weigh(const Words (&words)[at::count], const V& bends,
                                                   const lane_points<V>& points, const lane_points<V>& normals,
                                                   const lookup_limits<float>& limits, const Words& among) {
        seen<V> s = look(words, points, normals, limits);
        s.weight = weight(limits.metric, s.t2, s.turn);
        const Words used = among & s.good & (V::all(0) < s.weight);
        addends<V> a = add(words, s, bends, limits.together, std::make_index_sequence<bands>{});
        a.used = used;
        a.judged = Words::pick(used, is<Words>(verdict::used), s.judged);
        return a;
    }

private:
    using slopes = compact_gradients<S, float>;

    template <typename Words, std::size_t... Some>
    [[gnu::always_inline]] static void read([[maybe_unused]] const char* const* records, [[maybe_unused]] Words* words,
                                            std::index_sequence<Some...>) {
        constexpr std::size_t some = Words::together;
        (Words::columns(records, Some * some * sizeof(std::int32_t), words + Some * some), ...);
    }

    /// A point as each lane sees it.
    template <typename V>
    struct seen {
        typename V::words judged, good;
        V t2, turn, weight;
        V offset[4];
    };

    template <typename V, typename Words>
    [[gnu::always_inline]] static seen<V> look(const Words* words, const lane_points<V>& point, const lane_points<V>& n,
                                               const lookup_limits<float>& limits) {
        const V radius = V::from_bits(words[at::radius]);
        const lane_tilts<V> facing = lane_tilts<V>::of(words[at::normal]);
        const lane_points<V> way =
            lane_points<V>::difference(point, {V::from_bits(words[at::position]), V::from_bits(words[at::position + 1]),
                                               V::from_bits(words[at::position + 2])});
        const lane_points<V> along = facing.to_local(way);
        const lane_points<V> bent = lane_points<V>::difference(n, facing.normal);
        const V turn = lane_points<V>::dot(bent, bent) * V::all(0.5f);
        const V height = (lane_points<V>::dot(way, n) + along.z) * V::all(0.5f);
        const V scale = V::all(1) / radius;
        const lane_points<V> local{along.x * scale, along.y * scale, along.z * scale};
        const lane_points<V> turned = facing.to_local(n);
        seen<V> s;
        s.t2 = distance2(words, local);
        s.turn = turn * V::all(1 / limits.turn);
        const auto near = s.t2 < V::all(1);
        const auto level = V::abs(height) <= V::all(limits.plane) * radius;
        const auto alike = turn < V::all(limits.turn);
        s.good = near & level & alike;
        s.judged = Words::pick(alike, Words::pick(level, is<Words>(verdict::distance), is<Words>(verdict::plane)),
                               is<Words>(verdict::normal));
        const std::array<float, 4> k = slopes::factors({1, 1, 1, 1});
        s.offset[0] = local.x * V::all(k[0] * half_unit);
        s.offset[1] = local.y * V::all(k[1] * half_unit);
        s.offset[2] = turned.y * V::all(-k[2] * half_unit);
        s.offset[3] = turned.x * V::all(k[3] * half_unit);
        return s;
    }

    template <typename Words>
    [[gnu::always_inline]] static Words is(verdict v) {
        return Words::all(static_cast<std::int32_t>(v));
    }

    template <typename Words, typename V>
    [[gnu::always_inline]] static V distance2(const Words* words, const lane_points<V>& p) {
        V flat = p.x * p.x + p.y * p.y;
        if constexpr (F.ellipse) {
            const V step = V::all(compact_ellipse::step * half_unit);
            const V x = V::of(Words::first_half(words[at::ellipse])) * step;
            const V y = V::of(Words::last_half(words[at::ellipse])) * step;
            const V along = x * p.x + y * p.y;
            flat = V::max(flat - along * along, V::all(0));
        }
        return flat + p.z * p.z;
    }

    template <typename V>
    [[gnu::always_inline]] static V weight(error_metric metric, const V& t2, const V& turn) {
        const V one = V::all(1), t = V::root(t2);
        if (metric == error_metric::hessian) { return (one - t) * (one - turn); }
        const V bend = V::root(turn);
        if (metric == error_metric::nearest_distance) { return one - V::max(t, bend); }
        return one - t - bend;
    }

    /// How the light of band `B` goes on, relative to what it is: `compact_gradients::extrapolate`.
    template <std::size_t B, typename Words, typename V>
    [[gnu::always_inline]] static V change(const Words* words, const seen<V>& s) {
        if constexpr (F.gradients) {
            return code<B, V>(words) * s.offset[0] + code<bands + B, V>(words) * s.offset[1] +
                   (code<2 * bands + B, V>(words) * s.offset[2] + code<3 * bands + B, V>(words) * s.offset[3]);
        } else {
            return V::all(0);
        }
    }
    template <std::size_t Code, typename V, typename Words>
    [[gnu::always_inline]] static V code(const Words* words) {
        const Words both = words[at::slopes + Code / 2];
        return V::of(Code % 2 == 0 ? Words::first_half(both) : Words::last_half(both));
    }

    template <typename Words, typename V, std::size_t... B>
    [[gnu::always_inline]] static addends<V> add(const Words* words, const seen<V>& s, const V& bend, float together,
                                                 std::index_sequence<B...>) {
        const V changes[bands] = {change<B>(words, s)...};
        const V light[bands] = {V::from_bits(words[at::light + B])...};
        V least = changes[0], most = light[0];
        ((least = V::min(least, changes[B]), most = V::max(most, light[B])), ...);
        // slopes::drop: least < -lowest ? -least : lowest
        const V lowest = V::all(slopes::lowest);
        const V damping = lowest / V::max(lowest, V::all(0) - least);
        const V scale = s.weight * most;
        addends<V> a{{},
                     {},
                     {s.weight * (light[B] + light[B] * changes[B] * damping)..., s.weight, scale * (s.t2 * bend)},
                     V::all(0)};
        if constexpr (F.noise) {
            const V code = V::of(words[at::noise] & Words::all(0xffff));
            const V noise = scale * (code / V::max(V::all(65534) - code, V::all(1)));
            const V shared = V::all(together) * noise;
            a.parts[bands + 1] = a.parts[bands + 1] + shared;
            a.noise = noise - shared;
        }
        return a;
    }
};

/// Adds up eight addends.
template <typename V, std::size_t Bands, typename Addends, std::size_t... Part>
[[gnu::always_inline]] inline void add_used(const Addends& a, lane_sums<Bands>& sums, std::index_sequence<Part...>) {
    const V parts[] = {V::where(a.used, a.parts[Part])...};
    V::add_sums(parts, sums.parts);
    sums.variance += V::sum_of_squares(V::where(a.used, a.noise));
    sums.records += V::words::count_of(a.used);
}

/// Adds what the first `some` of eight records say of a point to `sums`, and tells each one's verdict.
template <typename S, record_features F>
struct add_eight {
    /// Expects good addresses in all eight.
    template <typename V>
    [[gnu::always_inline]] static void run(const char* const* records, const float* bends, std::size_t some,
                                           const vec3<float>& point, const vec3<float>& normal,
                                           const lookup_limits<float>& limits, lane_sums<packed_bands<S>>& sums,
                                           std::int32_t* judged) {
        using lane = lane_records<S, F>;
        using points = lane_points<V>;
        typename V::words words[lane::at::count];
        lane::read(records, words);
        const auto a = lane::template weigh<V>(words, V::load(bends), points::all(point), points::all(normal), limits,
                                               V::words::below(some));
        V::words::store(judged, a.judged);
        add_used<V>(a, sums, std::make_index_sequence<lane::bands + 2>{});
    }
};

}  // namespace aglow::detail
