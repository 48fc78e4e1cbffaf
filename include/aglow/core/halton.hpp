// A scrambled Halton sequence: points of many dimensions, evenly spread however many of them are drawn.
//
// Halton 1960; digits permuted at random for each dimension and digit place, the endless zeros in front of an index
// among them (Owen 2017, A randomized Halton algorithm in R). Trades a table of some 300 KB for exact digits.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <aglow/core/random.hpp>

namespace aglow {

/// The permuted digits of all dimensions, made from (seed, pass) once and read by every path of that pass.
/// `const`, safe from many threads. Made in about a millisecond at the default number of dimensions.
class halton_scrambling {
public:
    /// Throws `std::invalid_argument` for more than 1000 `dimensions`. What is drawn beyond them is hashed, not Halton.
    explicit halton_scrambling(std::uint64_t seed, std::uint64_t pass = 0, std::size_t dimensions = 64);

    [[nodiscard]] std::uint64_t seed() const { return seed_; }
    [[nodiscard]] std::uint64_t pass() const { return pass_; }

    /// How many dimensions are a Halton sequence's.
    [[nodiscard]] std::size_t dimensions() const { return axes_.size(); }

    /// The prime whose powers stratify `dimension`. Expects `dimension` < `dimensions()`.
    [[nodiscard]] std::uint32_t base(std::size_t dimension) const { return axes_[dimension].base; }

    /// Coordinate `dimension` of point `index`, in [0, 1), never 1: a multiple of 2^-24 (float), or right to 2^-50
    /// (double). Any base^k points in a row have one in each base^k-th of [0, 1), to that precision.
    /// From `dimensions()` on: a hash of (seed, pass, index, dimension).
    template <std::floating_point T>
    [[nodiscard]] T number(std::uint64_t index, std::size_t dimension) const {
        if (dimension >= axes_.size()) { return hashed<T>(index, dimension); }
        const axis& a = axes_[dimension];
        const auto reversed = static_cast<std::int64_t>(permuted(a, index));
        const double x = std::min(static_cast<double>(reversed) * a.step, one_below<double>);
        if constexpr (sizeof(T) == 4) {
            // Cut, not rounded: rounding would reach 1 and leave the stratum.
            return static_cast<T>(static_cast<std::int32_t>(x * 0x1p24)) * T(0x1p-24);
        } else {
            return T(x);
        }
    }

private:
    /// Digits are read `block` = base^digits at a time: one look-up in a table of permuted, reversed digits.
    struct axis {
        std::uint32_t base;
        std::uint32_t block;
        std::uint32_t reciprocal;  ///< floor(2^32 / block)
        std::uint32_t places;      ///< blocks that fit into 63 bits; those beyond stand below 2^-50
        std::size_t table;         ///< of the first place; each place has `block` entries
        std::size_t ending;        ///< after no place; each place more has the next
        double step;               ///< block^-places
    };
    /// What completes a number whose first places were read: it stands `weight` high, and the permuted zeros follow.
    struct ending {
        std::uint64_t weight;
        std::uint64_t zeros;
    };

    [[nodiscard]] std::uint64_t permuted(const axis& a, std::uint64_t index) const {
        const std::uint16_t* table = digits_.data() + a.table;
        std::uint64_t value = 0;
        std::uint32_t place = 0;
        for (; (index >> 32) != 0; ++place, table += a.block) {
            value = value * a.block + table[index % a.block];
            index /= a.block;
        }
        auto rest = static_cast<std::uint32_t>(index);
        for (; rest != 0 && place < a.places; ++place, table += a.block) {
            // The quotient by multiplication; too small by one at the most.
            auto quotient = static_cast<std::uint32_t>((std::uint64_t{rest} * a.reciprocal) >> 32);
            std::uint32_t digit = rest - quotient * a.block;
            if (digit >= a.block) {
                digit -= a.block;
                ++quotient;
            }
            value = value * a.block + table[digit];
            rest = quotient;
        }
        const ending& e = endings_[a.ending + place];
        return value * e.weight + e.zeros;
    }

    template <std::floating_point T>
    [[nodiscard]] T hashed(std::uint64_t index, std::size_t dimension) const {
        return unit_interval<T>(mix(mix(path_key{seed_, pass_, index}, 0, purpose::emission), dimension));
    }

    void add_axis(std::uint32_t base);
    void add_place(const axis& a, std::uint32_t digits, random_sampler<double>& random);

    std::uint64_t seed_;
    std::uint64_t pass_;
    std::vector<axis> axes_{};
    std::vector<std::uint16_t> digits_{};
    std::vector<ending> endings_{};
};

namespace detail {

/// The largest block of digits that one look-up reads; a base above it is its own block.
inline constexpr std::uint32_t halton_block = 1024;

/// The prime after `p`.
[[nodiscard]] constexpr std::uint32_t next_prime(std::uint32_t p) {
    for (bool divided = true; divided;) {
        ++p;
        divided = false;
        for (std::uint32_t d = 2; d * d <= p && !divided; ++d) { divided = p % d == 0; }
    }
    return p;
}

/// How often `factor` goes into `limit` as a power: the largest n with factor^n <= limit.
[[nodiscard]] constexpr std::uint32_t log_floor(std::uint64_t limit, std::uint64_t factor) {
    std::uint32_t n = 0;
    for (; limit >= factor; limit /= factor) { ++n; }
    return n;
}

}  // namespace detail

inline halton_scrambling::halton_scrambling(std::uint64_t seed, std::uint64_t pass, std::size_t dimensions)
    : seed_{seed}, pass_{pass} {
    if (dimensions > 1000) {
        throw std::invalid_argument("halton_scrambling: dimensions = " + std::to_string(dimensions) + ", above 1000");
    }
    std::uint32_t prime = 1;
    for (std::size_t i = 0; i < dimensions; ++i) {
        prime = detail::next_prime(prime);
        add_axis(prime);
    }
}

inline void halton_scrambling::add_axis(std::uint32_t base) {
    const std::uint32_t digits = std::max(1u, detail::log_floor(detail::halton_block, base));
    std::uint32_t block = 1;
    for (std::uint32_t i = 0; i < digits; ++i) { block *= base; }
    axis a{.base = base,
           .block = block,
           .reciprocal = static_cast<std::uint32_t>((std::uint64_t{1} << 32) / block),
           .places = detail::log_floor(std::uint64_t{1} << 63, block),
           .table = digits_.size(),
           .ending = endings_.size(),
           .step = 1};
    random_sampler<double> random{mix(path_key{seed_, pass_, base}, 0, purpose::emission)};
    for (std::uint32_t i = 0; i < a.places; ++i) { add_place(a, digits, random); }
    endings_.resize(a.ending + a.places + 1);
    ending e{1, 0};
    for (std::uint32_t place = a.places;; --place) {
        endings_[a.ending + place] = e;
        if (place == 0) { break; }
        e.zeros += e.weight * digits_[a.table + (place - 1) * block];
        e.weight *= block;
    }
    a.step = 1 / static_cast<double>(e.weight);
    axes_.push_back(a);
}

/// Appends the table of one place: for each block of `digits` digits, the least significant first, the permuted digits
/// with the order reversed.
inline void halton_scrambling::add_place(const axis& a, std::uint32_t digits, random_sampler<double>& random) {
    std::vector<std::uint16_t> order(a.base);
    digits_.resize(digits_.size() + a.block);
    std::uint16_t* const table = digits_.data() + (digits_.size() - a.block);
    std::uint32_t built = 1;
    for (std::uint32_t digit = 0; digit < digits; ++digit) {
        for (std::uint32_t i = 0; i < a.base; ++i) { order[i] = static_cast<std::uint16_t>(i); }
        for (std::uint32_t i = a.base; i > 1; --i) {
            const auto j = static_cast<std::uint32_t>(random.next_1d() * i);
            std::swap(order[i - 1], order[j]);
        }
        // From the last on: what was built stands where the first go.
        for (std::uint32_t next = a.base; next-- > 0;) {
            for (std::uint32_t before = 0; before < built; ++before) {
                table[next * built + before] = static_cast<std::uint16_t>(table[before] * a.base + order[next]);
            }
        }
        built *= a.base;
    }
}

/// The numbers of one decision: so many Halton dimensions, hashed random numbers after them.
template <std::floating_point T>
class halton_sampler {
public:
    /// Dimensions [first, last) of point `index`, then the random numbers of `start`.
    halton_sampler(const halton_scrambling& table, std::uint64_t index, std::size_t first, std::size_t last,
                   std::uint64_t start)
        : table_{&table}, index_{index}, next_{first}, last_{last}, random_{start} {}

    T next_1d() { return next_ < last_ ? table_->number<T>(index_, next_++) : random_.next_1d(); }
    vec2<T> next_2d() {
        const T x = next_1d();
        return {x, next_1d()};
    }

private:
    const halton_scrambling* table_;
    std::uint64_t index_;
    std::size_t next_;
    std::size_t last_;
    random_sampler<T> random_;
};

/// The numbers of light path `index`, counted over the whole pass and never per thread: any first so many paths are
/// evenly spread. Bounce 0 is the emission and has the first 8 dimensions; each bounce from 1 on has the next 4, three
/// for the scattering and one for roulette. Every other purpose, what is drawn beyond these shares, and all bounces
/// past the table have random numbers, hashed.
template <std::floating_point T>
class halton_numbers {
public:
    using scalar = T;

    /// `table` must outlive the numbers.
    halton_numbers(const halton_scrambling& table, std::uint64_t index)
        : table_{&table}, key_{table.seed(), table.pass(), index} {}

    [[nodiscard]] halton_sampler<T> at(std::uint32_t bounce, purpose why) const {
        const auto [first, last] = dimensions_of(bounce, why);
        return {*table_, key_.path, first, std::min(last, table_->dimensions()), mix(key_, bounce, why)};
    }

    /// The numbers of a path that branches off this one: random, hashed, since the dimensions here are the trunk's.
    [[nodiscard]] halton_numbers fork(std::uint64_t branch) const {
        halton_numbers branched = *this;
        branched.key_.pass = mix(key_.pass, ~branch);
        branched.forked_ = true;
        return branched;
    }

private:
    static constexpr std::size_t of_emission = 8;
    static constexpr std::size_t of_scatter = 3;
    static constexpr std::size_t of_bounce = 4;

    struct share {
        std::size_t first;
        std::size_t last;
    };
    [[nodiscard]] share dimensions_of(std::uint32_t bounce, purpose why) const {
        if (forked_) { return {0, 0}; }
        if (bounce == 0) { return {0, why == purpose::emission ? of_emission : 0}; }
        const std::size_t first = of_emission + of_bounce * (std::size_t{bounce} - 1);
        if (why == purpose::scatter) { return {first, first + of_scatter}; }
        if (why == purpose::roulette) { return {first + of_scatter, first + of_bounce}; }
        return {0, 0};
    }

    const halton_scrambling* table_;
    path_key key_;
    bool forked_{false};
};

}  // namespace aglow
