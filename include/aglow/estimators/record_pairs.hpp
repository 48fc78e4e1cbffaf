// Many places and the records near each, blended with every lane in use.
//
// A blend of five records leaves three of eight lanes empty, and all of them when sixteen were to be had. Here each
// lane takes the next pair of a place and a record, whosever that is; what the pairs say is added up place by place, in
// the order and to the bits of `record_blend`.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

#include <aglow/core/simd_eight.hpp>
#include <aglow/core/simd_sixteen.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/irradiance_record.hpp>
#include <aglow/estimators/record_blend.hpp>
#include <aglow/estimators/record_lanes.hpp>
#include <aglow/estimators/record_view.hpp>

namespace aglow::detail {

/// Pairs of a place and a record, side by side.
template <std::size_t Bands>
struct pair_lanes {
    static constexpr std::size_t room = 512, most_places = 64, pad = 16;

    std::array<std::array<float, most_places + pad>, 6> places;  ///< point and normal, by place
    std::array<std::int32_t, room + pad> place;                  ///< of each pair, ascending, none left out
    std::array<std::uint32_t, room + pad> record;                ///< its number,
    std::array<const char*, room + pad> row;                     ///< and where it lies
    std::array<float, room + pad> bend;
    std::array<std::array<float, room + pad>, Bands + 2> parts;  ///< what each adds to its place, as of `lane_sums`
    std::array<float, room + pad> noise;
    std::array<std::int32_t, room + pad> used;
};

/// Weighs `count` pairs, or a few more, with `records[pairs.record[i]]`, in which an irradiance record comes first.
/// Expects good numbers for a pack more.
template <typename S, record_features F>
struct weigh_pairs {
    template <typename V, typename Record, typename Pairs>
    [[gnu::always_inline]] static void run(const Record* records, const float* bends, Pairs& pairs, std::size_t count,
                                           const lookup_limits<float>& limits) {
        for (std::size_t i = 0; i < count + V::count; ++i) {
            pairs.row[i] = reinterpret_cast<const char*>(records + pairs.record[i]);
        }
        for (std::size_t i = 0; i < count + V::count; ++i) { pairs.bend[i] = bends[pairs.record[i]]; }
        for (std::size_t i = 0; i < count; i += V::count) {
            weigh<V>(pairs, i, limits, std::make_index_sequence<packed_bands<S> + 2>{});
        }
    }

private:
    template <typename V, typename Pairs, std::size_t... Part>
    [[gnu::always_inline]] static void weigh(Pairs& pairs, std::size_t i, const lookup_limits<float>& limits,
                                             std::index_sequence<Part...>) {
        using lane = lane_records<S, F>;
        using words = typename V::words;
        words record[lane::at::count];
        lane::read(&pairs.row[i], record);
        const auto first = static_cast<std::size_t>(pairs.place[i]);
        const words place = words::load(&pairs.place[i]) - words::all(pairs.place[i]);
        const auto a =
            lane::template weigh<V>(record, V::load(&pairs.bend[i]), picked<V>(&pairs.places[0], first, place),
                                    picked<V>(&pairs.places[3], first, place), limits, words::all(-1));
        (V::store(&pairs.parts[Part][i], a.parts[Part]), ...);
        V::store(&pairs.noise[i], a.noise);
        words::store(&pairs.used[i], a.used);
    }
    template <typename V, typename Column>
    [[gnu::always_inline]] static lane_points<V> picked(const Column* columns, std::size_t first,
                                                        const typename V::words& place) {
        return {V::picked(&columns[0][first], place), V::picked(&columns[1][first], place),
                V::picked(&columns[2][first], place)};
    }
};

/// Adds up the pairs of each place, the last of which is the one before `ends[place]`.
template <typename S, record_features F>
struct sum_pairs {
    static constexpr std::size_t bands = packed_bands<S>;

    template <typename V>
    [[gnu::always_inline]] static void run(const pair_lanes<bands>& pairs, const std::uint32_t* ends,
                                           std::size_t places, lane_sums<bands>* sums) {
        std::size_t i = 0;
        for (std::size_t place = 0; place < places; ++place) {
            for (; i < ends[place]; i = std::min<std::size_t>(i + V::count, ends[place])) {
                add<V>(pairs, i, ends[place] - i, sums[place], std::make_index_sequence<bands + 2>{});
            }
        }
    }

private:
    template <typename V, std::size_t... Part>
    [[gnu::always_inline]] static void add(const pair_lanes<bands>& pairs, std::size_t i, std::size_t some,
                                           lane_sums<bands>& sums, std::index_sequence<Part...>) {
        const typename lane_records<S, F>::template addends<V> a{{},
                                                                 V::words::below(some) & V::words::load(&pairs.used[i]),
                                                                 {V::load(&pairs.parts[Part][i])...},
                                                                 V::load(&pairs.noise[i])};
        add_used<V>(a, sums, std::index_sequence<Part...>{});
    }
};

/// Blends for many places, of records and their bends by number.
template <typename S, record_features F, typename Record>
class record_pairs {
public:
    using answer = irradiance_answer<S, float>;

    record_pairs(const Record* records, const float* bends, const lookup_limits<float>& limits)
        : records_{records}, bends_{bends}, limits_{limits} {}

    /// Writes the answer for a place `to`, now or when `finish` is called. Expects a unit `normal`, at most `most`
    /// numbers of records, and that a pack more may be read behind them.
    void add(const vec3<float>& point, const vec3<float>& normal, std::span<const std::uint32_t> near, answer& to) {
        if (near.empty()) {
            to = {};
            return;
        }
        if (places_ == lanes::most_places || count_ + near.size() > lanes::room) { finish(); }
        for (std::size_t i = 0; i < near.size(); i += lanes::pad) {
            std::fill_n(&lanes_.place[count_ + i], lanes::pad, static_cast<std::int32_t>(places_));
            std::memcpy(&lanes_.record[count_ + i], &near[i], lanes::pad * sizeof(near[i]));
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            lanes_.places[axis][places_] = point[static_cast<int>(axis)];
            lanes_.places[3 + axis][places_] = normal[static_cast<int>(axis)];
        }
        count_ += near.size();
        ends_[places_] = static_cast<std::uint32_t>(count_);
        answers_[places_++] = &to;
    }
    static constexpr std::size_t most = 128;  ///< records near a place

    void finish() {
        if (count_ == 0) { return; }
        std::fill_n(&lanes_.record[count_], lanes::pad, lanes_.record[count_ - 1]);
        std::fill_n(&lanes_.place[count_], lanes::pad, lanes_.place[count_ - 1]);
        simd::run_best<simd::sixteen, weigh_pairs<S, F>>(records_, bends_, lanes_, count_, limits_);
        std::array<lane_sums<bands>, lanes::most_places> sums{};
        simd::run_best<simd::eight, sum_pairs<S, F>>(lanes_, ends_.data(), places_, sums.data());
        for (std::size_t i = 0; i < places_; ++i) {
            *answers_[i] = blend_sums<S, float>{}.add(sums[i]).answer(limits_.weight);
        }
        places_ = count_ = 0;
    }

private:
    static constexpr std::size_t bands = packed_bands<S>;
    using lanes = pair_lanes<bands>;

    const Record* records_;
    const float* bends_;
    const lookup_limits<float>& limits_;
    std::size_t places_ = 0;
    std::size_t count_ = 0;
    std::array<std::uint32_t, lanes::most_places> ends_;
    std::array<answer*, lanes::most_places> answers_;
    lanes lanes_;
};

}  // namespace aglow::detail
