// Unbiased looks at single pixels, kept in batches so that their own noise can be told from the error looked for.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <aglow/core/numbers.hpp>
#include <aglow/core/random.hpp>

namespace aglow {

/// An unbiased estimate of a pixel, drawn anew for every `seed`: a number, or something with one number a channel
/// behind
/// `[c]`. Asked from several threads at once.
template <typename P>
concept SingleProbe = requires(const P& probe, std::size_t pixel, std::uint64_t seed) {
    probe(pixel, seed);
};

/// The same, as the mean of `count` samples that may be spread well among themselves; different seeds are independent.
template <typename P>
concept BatchProbe = requires(const P& probe, std::size_t pixel, std::uint64_t seed, std::size_t count) {
    probe(pixel, seed, count);
};

template <typename P>
concept Probe = SingleProbe<P> || BatchProbe<P>;

/// A probe that knows how much light broken answers of its host have cost so far, as a number of samples: what an audit
/// holds against it.
template <typename P>
concept KnowsLoss = requires(const P& probe) {
    { probe.lost() } -> std::convertible_to<double>;
};

/// How many independent batches make one probe.
inline constexpr std::size_t probe_batches = 8;

/// What was seen of one pixel: `probe_batches` independent unbiased estimates of every channel.
struct probe_record {
    std::size_t pixel{0};
    std::size_t channels{1};
    std::vector<double> batches{};  ///< [batch][channel]
    std::size_t samples{0};         ///< all samples spent
    std::size_t broken{0};          ///< answers that were infinite or NaN and were left out
    double weight{1};               ///< uniform density over that of the pixel's drawing
    bool uniform{true};             ///< whether it was drawn uniformly

    /// Takes in the samples of `more`, of the same pixel.
    void merge(const probe_record& more) {
        const double share = static_cast<double>(more.samples) / static_cast<double>(samples + more.samples);
        for (std::size_t i = 0; i < batches.size(); ++i) { batches[i] += share * (more.batches[i] - batches[i]); }
        samples += more.samples;
        broken += more.broken;
    }

    /// Mean of channel `c` over the batches whose bits are set in `chosen`.
    [[nodiscard]] double mean(unsigned chosen, std::size_t c) const {
        double sum = 0;
        for (std::size_t b = 0; b < probe_batches; ++b) {
            if ((chosen >> b & 1u) != 0) { sum += batches[b * channels + c]; }
        }
        return sum / std::popcount(chosen);
    }

    /// The best estimate of channel `c`: the mean of all batches.
    [[nodiscard]] double mean(std::size_t c) const { return mean((1u << probe_batches) - 1, c); }

    /// Sample variance of one batch of channel `c`.
    [[nodiscard]] double batch_variance(std::size_t c) const {
        const double centre = mean(c);
        double sum = 0;
        for (std::size_t b = 0; b < probe_batches; ++b) { sum += square(batches[b * channels + c] - centre); }
        return sum / (probe_batches - 1);
    }
};

/// The 8-bit words with `size` bits set: all ways to choose so many batches.
template <int size>
inline constexpr auto batch_choices = [] {
    constexpr std::size_t count = size == 2 ? 28 : size == 4 ? 70 : 1;
    std::array<unsigned, count> words{};
    std::size_t next = 0;
    for (unsigned word = 0; word < 256; ++word) {
        if (std::popcount(word) == size) { words[next++] = word; }
    }
    return words;
}();

/// `of(chosen)`, a function of the mean of the chosen batches, averaged over all choices of `size` batches.
template <int size, typename Of>
[[nodiscard]] double mean_over_choices(const Of& of) {
    double sum = 0;
    for (const unsigned chosen : batch_choices<size>) { sum += of(chosen); }
    return sum / static_cast<double>(batch_choices<size>.size());
}

/// `of` at the mean of the batches, freed of most of what their noise adds to it. For of = |x| and normal noise the
/// expectation is at or above the noise-free value for every x, and the excess is about half of that of the plain
/// value: 3 f(all) - 2.8 f(halves) + 0.8 f(quarters), weights found by a search over all that never fall below.
template <typename Of>
[[nodiscard]] double less_noisy(const Of& of) {
    return 3 * mean_over_choices<8>(of) - 2.8 * mean_over_choices<4>(of) + 0.8 * mean_over_choices<2>(of);
}

namespace detail {

template <typename V>
[[nodiscard]] double probed_channel(const V& value, std::size_t c) {
    if constexpr (std::convertible_to<V, double>) {
        return static_cast<double>(value);
    } else if constexpr (requires { typename V::length_type; }) {
        return static_cast<double>(value[static_cast<typename V::length_type>(c)]);  // GLM counts with int
    } else {
        return static_cast<double>(value[c]);
    }
}

/// Adds `value` to `sums` if all its channels are finite; says whether they were.
template <typename V>
[[nodiscard]] bool add_if_finite(const V& value, std::span<double> sums) {
    for (std::size_t c = 0; c < sums.size(); ++c) {
        if (!is_finite(probed_channel(value, c))) { return false; }
    }
    for (std::size_t c = 0; c < sums.size(); ++c) { sums[c] += probed_channel(value, c); }
    return true;
}

/// Sums `count` samples as one batch into `sums` and divides by how many were finite.
template <Probe P>
void draw_batch(const P& probe, const path_key& key, std::size_t first, std::size_t count, probe_record& record,
                std::span<double> sums) {
    const auto seed = [&](std::size_t i) { return mix(key, static_cast<std::uint32_t>(i), purpose::audit); };
    std::size_t good = 0;
    if constexpr (BatchProbe<P>) {
        good = add_if_finite(probe(record.pixel, seed(first), count), sums) ? 1 : 0;
        record.broken += 1 - good;
    } else {
        for (std::size_t i = 0; i < count; ++i) {
            good += add_if_finite(probe(record.pixel, seed(first + i)), sums) ? 1u : 0u;
        }
        record.broken += count - good;
    }
    for (double& sum : sums) { sum /= good > 0 ? static_cast<double>(good) : 1.0; }
}

}  // namespace detail

/// Looks at `pixel` with `per_batch` samples in each batch; `key` names the random numbers, used for nothing else.
template <Probe P>
[[nodiscard]] probe_record draw_probe(const P& probe, std::size_t pixel, std::size_t channels, std::size_t per_batch,
                                      const path_key& key) {
    probe_record record{.pixel = pixel, .channels = channels};
    record.batches.assign(probe_batches * channels, 0.0);
    record.samples = probe_batches * per_batch;
    for (std::size_t b = 0; b < probe_batches; ++b) {
        const std::span<double> sums{record.batches.data() + b * channels, channels};
        detail::draw_batch(probe, key, b * per_batch, per_batch, record, sums);
    }
    return record;
}

}  // namespace aglow
