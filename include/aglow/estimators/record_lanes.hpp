// Eight records of gray or RGB light side by side, so that a blend weighs them all at once.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include <aglow/core/numbers.hpp>
#include <aglow/core/stereographic.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/compact_gradients.hpp>
#include <aglow/estimators/irradiance_record.hpp>
#include <aglow/estimators/record_view.hpp>

namespace aglow::detail {

/// Whether records of such light have a place in lanes.
template <typename S, typename T>
inline constexpr bool has_lanes = std::same_as<T, float>&& packed_bands<S> > 0;

/// What a blend sums up, by lane: the i-th of each eight records goes into lane i.
template <std::size_t Bands>
struct lane_sums {
    static constexpr std::size_t count = 8;
    float light[Bands][count]{};
    float weight[count]{};
    float error[count]{};
    double variance[count]{};  ///< squares of faint light leave the range of floats
    std::uint32_t records{0};

    /// The sum over the lanes, in a fixed order.
    template <typename X>
    [[nodiscard]] static X total(const X (&lane)[count]) {
        X half[4];
        for (std::size_t i = 0; i < 4; ++i) { half[i] = lane[i] + lane[i + 4]; }
        return (half[0] + half[2]) + (half[1] + half[3]);
    }
};

/// The sums of lanes for such light; `Without` where it has no lanes.
template <typename S, typename T, typename Without>
using lanes_or = std::conditional_t<has_lanes<S, T>, lane_sums<packed_bands<S> == 0 ? 1 : packed_bands<S>>, Without>;

template <typename S>
[[nodiscard]] S light_of(const lane_sums<packed_bands<S>>& sums) {
    if constexpr (packed_bands<S> == 1) {
        return sums.total(sums.light[0]);
    } else {
        return {sums.total(sums.light[0]), sums.total(sums.light[1]), sums.total(sums.light[2])};
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

/// Eight records as they are kept, the same word of all side by side. The loops below run over lanes alone and take no
/// branch, which is how a compiler likes them.
template <typename S, record_features F>
class record_lanes {
public:
    static constexpr std::size_t count = 8;
    static constexpr std::size_t bands = packed_bands<S>;
    using record = irradiance_record<S, float, F>;
    using items = std::array<const record*, count>;

    /// Expects good addresses in all eight.
    [[gnu::always_inline]] record_lanes(const items& records, const std::array<float, count>& bends) : bend_{bends} {
        static_assert(std::is_trivially_copyable_v<record> && std::is_standard_layout_v<record>);
        static_assert(F.incident || sizeof(record) == sizeof(word) * at::count);
#if defined(__GNUC__)
        for (std::size_t first = 0; first < by_four; first += 4) { turn_four(records, first); }
#endif
        for (std::size_t w = by_four; w < at::count; ++w) {
            for (std::size_t i = 0; i < count; ++i) {
                std::memcpy(&words_[w][i], reinterpret_cast<const char*>(records[i]) + w * sizeof(word), sizeof(word));
            }
        }
    }

    /// Adds what the first `some` of them say of a point to `sums`; gives each one's verdict.
    [[gnu::always_inline]] std::array<verdict, count> add_to(lane_sums<bands>& sums, std::size_t some,
                                                             const vec3<float>& point, const vec3<float>& normal,
                                                             const lookup_limits<float>& limits) const {
        seen s;
        look_at(s, some, point, normal, limits);
        weigh(s, limits);
        add(s, sums, std::make_index_sequence<bands>{});
        std::array<verdict, count> judged;
        for (std::size_t i = 0; i < count; ++i) { judged[i] = static_cast<verdict>(s.judged[i]); }
        return judged;
    }

private:
    using word = std::int32_t;
    using at = record_words<bands, F>;
    using slopes = compact_gradients<S, float>;
#if defined(__GNUC__)
    static constexpr std::size_t by_four = at::count / 4 * 4;
#else
    static constexpr std::size_t by_four = 0;
#endif

    /// A point as each lane sees it.
    struct seen {
        word judged[count];
        float t2[count], turn[count], weight[count];
        float offset[4][count];
    };

    /// The two numbers of sixteen bits in a word, in the order of their addresses.
    [[nodiscard]] static word half(word w, std::size_t which) {
        return (which == 0) == (std::endian::native == std::endian::little)
                   ? static_cast<word>(static_cast<std::uint32_t>(w) << 16) >> 16
                   : w >> 16;
    }

#if defined(__GNUC__)
    /// Four words of eight records: four by four are turned in each half of a register.
    [[gnu::always_inline]] void turn_four(const items& records, std::size_t first) {
        using four [[gnu::vector_size(16)]] = word;
        using eight [[gnu::vector_size(32)]] = word;
        eight row[4], pair[4], turned[4];
        for (std::size_t i = 0; i < 4; ++i) {
            four low, high;
            std::memcpy(&low, reinterpret_cast<const char*>(records[i]) + first * sizeof(word), sizeof(low));
            std::memcpy(&high, reinterpret_cast<const char*>(records[i + 4]) + first * sizeof(word), sizeof(high));
            row[i] = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
        }
        for (std::size_t i = 0; i < 4; i += 2) {
            pair[i] = __builtin_shufflevector(row[i], row[i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
            pair[i + 1] = __builtin_shufflevector(row[i], row[i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
        }
        for (std::size_t i = 0; i < 2; ++i) {
            turned[2 * i] = __builtin_shufflevector(pair[i], pair[i + 2], 0, 1, 8, 9, 4, 5, 12, 13);
            turned[2 * i + 1] = __builtin_shufflevector(pair[i], pair[i + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        }
        for (std::size_t i = 0; i < 4; ++i) { std::memcpy(words_[first + i], &turned[i], sizeof(eight)); }
    }
#endif

    [[nodiscard, gnu::always_inline]] float number(std::size_t w, std::size_t i) const {
        return std::bit_cast<float>(words_[w][i]);
    }
    [[nodiscard, gnu::always_inline]] record_shape<float> shape(std::size_t i) const {
        const word normal = words_[at::normal][i], ellipse = F.ellipse ? words_[at::ellipse][i] : 0;
        return {{number(at::position, i), number(at::position + 1, i), number(at::position + 2, i)},
                number(at::radius, i),
                stereographic::turned<float>(half(normal, 0), half(normal, 1)),
                compact_ellipse::value<float>(half(ellipse, 0), half(ellipse, 1))};
    }

    [[gnu::always_inline]] void look_at(seen& s, std::size_t some, const vec3<float>& point, const vec3<float>& normal,
                                        const lookup_limits<float>& limits) const {
        const vec3<float> p = point, n = normal;
        const lookup_limits<float> within = limits;
        const word last = static_cast<word>(some);
        for (std::size_t i = 0; i < count; ++i) {
            const record_view<float> view = look(shape(i), p, n, within);
            s.judged[i] = static_cast<word>(i) < last ? static_cast<word>(view.judged) : word(verdict::distance);
            s.t2[i] = view.t2;
            s.turn[i] = view.turn / within.turn;
            const auto k = slopes::factors({view.local.x, view.local.y, -view.normal.y, view.normal.x});
            s.offset[0][i] = k[0], s.offset[1][i] = k[1], s.offset[2][i] = k[2], s.offset[3][i] = k[3];
        }
    }

    [[gnu::always_inline]] static void weigh(seen& s, const lookup_limits<float>& limits) {
        switch (limits.metric) {
            case error_metric::hessian: return weigh<error_metric::hessian>(s);
            case error_metric::nearest_distance: return weigh<error_metric::nearest_distance>(s);
            case error_metric::split_sphere: return weigh<error_metric::split_sphere>(s);
        }
    }
    /// What is not used is seen from where the record is, so that nothing in it can grow beyond numbers.
    template <error_metric Metric>
    [[gnu::always_inline]] static void weigh(seen& s) {
        for (std::size_t i = 0; i < count; ++i) {
            const float weight = record_weight<Metric>(s.t2[i], s.turn[i]);
            const word beyond = weight > 0 ? word(verdict::used) : word(verdict::distance);
            const word judged = s.judged[i] == word(verdict::used) ? beyond : s.judged[i];
            s.judged[i] = judged;
            s.weight[i] = judged == word(verdict::used) ? weight : 0.0f;
            s.t2[i] = judged == word(verdict::used) ? s.t2[i] : 0.0f;
        }
        for (auto& offset : s.offset) {
            for (std::size_t i = 0; i < count; ++i) {
                offset[i] = s.judged[i] == word(verdict::used) ? offset[i] : 0.0f;
            }
        }
    }

    /// How the light of band `B` goes on, relative to what it is: `compact_gradients::extrapolate`.
    template <std::size_t B>
    [[gnu::always_inline]] void find_change(const seen& s, float (&change)[count]) const {
        for (std::size_t i = 0; i < count; ++i) {
            change[i] = code<B>(i) * s.offset[0][i] + code<bands + B>(i) * s.offset[1][i] +
                        (code<2 * bands + B>(i) * s.offset[2][i] + code<3 * bands + B>(i) * s.offset[3][i]);
        }
    }
    template <std::size_t Code>
    [[nodiscard, gnu::always_inline]] float code(std::size_t i) const {
        return static_cast<float>(F.gradients ? half(words_[at::slopes + Code / 2][i], Code % 2) : 0);
    }

    /// Takes the extremes of a band into account.
    template <std::size_t B>
    [[gnu::always_inline]] void widen(const float (&change)[count], float (&least)[count], float (&most)[count]) const {
        for (std::size_t i = 0; i < count; ++i) {
            const float light = number(at::light + B, i);
            least[i] = change[i] < least[i] ? change[i] : least[i];
            most[i] = light > most[i] ? light : most[i];
        }
    }
    template <std::size_t B>
    [[gnu::always_inline]] void add_light(const seen& s, const float (&change)[count], const float (&damping)[count],
                                          float (&sum)[count]) const {
        for (std::size_t i = 0; i < count; ++i) {
            const float light = number(at::light + B, i);
            sum[i] += s.weight[i] * (light + light * change[i] * damping[i]);
        }
    }

    /// Bands by number, since a loop over them that is left as one would stand between the others.
    template <std::size_t... B>
    [[gnu::always_inline]] void add(const seen& s, lane_sums<bands>& sums, std::index_sequence<B...>) const {
        lane_sums<bands> all = sums;  // a copy, which nothing that is read can be
        float change[bands][count], least[count], most[count];
        for (std::size_t i = 0; i < count; ++i) { least[i] = slopes::lowest, most[i] = number(at::light, i); }
        (find_change<B>(s, change[B]), ...);
        (widen<B>(change[B], least, most), ...);
        for (std::size_t i = 0; i < count; ++i) { least[i] = slopes::drop(least[i]); }
        for (std::size_t i = 0; i < count; ++i) { least[i] = slopes::lowest / least[i]; }
        (add_light<B>(s, change[B], least, all.light[B]), ...);
        float noise[count];
        for (std::size_t i = 0; i < count; ++i) {
            const float scale = s.weight[i] * most[i];
            all.weight[i] += s.weight[i];
            all.error[i] += scale * (s.t2[i] * bend_[i]);
            noise[i] = scale * compact_noise::noise<float>(F.noise ? half(words_[at::noise][i], 0) & 0xffff : 0);
        }
        for (std::size_t i = 0; i < count; ++i) {
            all.variance[i] += static_cast<double>(noise[i]) * static_cast<double>(noise[i]);
        }
        word used = 0;
        for (std::size_t i = 0; i < count; ++i) { used += s.judged[i] == word(verdict::used) ? 1 : 0; }
        all.records += static_cast<std::uint32_t>(used);
        sums = all;
    }

    alignas(32) word words_[at::count][count];
    std::array<float, count> bend_;
};

/// Adds what the first `some` of eight records say of a point to `sums`; gives each one's verdict.
template <typename S, record_features F>
[[gnu::always_inline]] inline std::array<verdict, 8> add_lanes(
    const std::array<const irradiance_record<S, float, F>*, 8>& records, const std::array<float, 8>& bends,
    std::size_t some, const vec3<float>& point, const vec3<float>& normal, const lookup_limits<float>& limits,
    lane_sums<packed_bands<S>>& sums) {
    return record_lanes<S, F>{records, bends}.add_to(sums, some, point, normal, limits);
}

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__AVX2__)
template <typename... Arguments>
[[gnu::target("avx2"), gnu::flatten, gnu::noinline]] std::array<verdict, 8> add_wide(Arguments&... arguments) {
    return add_lanes(arguments...);
}
#endif

/// The same, all eight at once where the machine has the registers for it. A function of its own, or else a compiler
/// loses sight of what is apart in memory, and takes lane after lane.
template <typename... Arguments>
[[gnu::noinline]] std::array<verdict, 8> add_eight(Arguments&... arguments) {
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__AVX2__)
    if (__builtin_cpu_supports("avx2")) { return add_wide(arguments...); }
#endif
    return add_lanes(arguments...);
}

}  // namespace aglow::detail
