// A film, or what is like one, as an audit wants to see it: plain numbers, and a guess of each pixel's error.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include <aglow/core/parallel.hpp>
#include <aglow/report/audit.hpp>

namespace aglow {

/// Pixels of light with a guess of the error of each, as `film` has them.
template <typename F>
concept Film = requires(const F& film, std::size_t at) {
    { film.width() } -> std::convertible_to<std::size_t>;
    { film.height() } -> std::convertible_to<std::size_t>;
    film.radiance(at, at);
    { film.error(at, at) } -> std::floating_point;
};

namespace detail {

/// Calls `take` with each channel of a colour: of a plain number, or of a row of them such as `glm::vec3`.
template <typename Colour, typename Take>
void for_each_channel(const Colour& colour, const Take& take) {
    if constexpr (std::is_floating_point_v<Colour>) {
        take(colour);
    } else if constexpr (requires { colour.size(); }) {
        for (std::size_t i = 0; i < colour.size(); ++i) { take(colour[i]); }
    } else {
        for (int i = 0; i < static_cast<int>(colour.length()); ++i) { take(colour[i]); }
    }
}

}  // namespace detail

/// The numbers of a film at one moment.
template <std::floating_point T>
class audited_film {
public:
    /// `channels` makes numbers of a pixel's light: one, or a row of them with `size()` or `length()`. Colours that are
    /// so themselves need none.
    template <Film F, typename Channels = std::identity>
    explicit audited_film(const F& film, const Channels& channels = {}) : width_{film.width()}, height_{film.height()} {
        for (std::size_t y = 0; y < height_; ++y) {
            for (std::size_t x = 0; x < width_; ++x) {
                detail::for_each_channel(channels(film.radiance(x, y)),
                                         [&](auto value) { values_.push_back(static_cast<T>(value)); });
                guess_.push_back(static_cast<T>(film.error(x, y)));
            }
        }
    }

    [[nodiscard]] const std::vector<T>& values() const { return values_; }
    [[nodiscard]] const std::vector<T>& guess() const { return guess_; }

    /// What audits read, with the class of each pixel where there are such; it lasts as long as this.
    [[nodiscard]] audited_picture<T> view(std::span<const std::uint32_t> classes = {}) const& {
        const std::size_t channels = guess_.empty() ? 1 : values_.size() / guess_.size();
        return {.image = {values_, width_, height_, channels}, .guess = guess_, .classes = classes};
    }
    audited_picture<T> view(std::span<const std::uint32_t> classes = {}) const&& = delete;

private:
    std::size_t width_;
    std::size_t height_;
    std::vector<T> values_{};
    std::vector<T> guess_{};
};

template <Film F, typename... Channels>
audited_film(const F&, const Channels&...)
    -> audited_film<std::remove_cvref_t<decltype(std::declval<const F&>().error(0, 0))>>;

/// Audits what a film shows, without classes.
template <Film F, Probe P, Executor E = in_sequence>
[[nodiscard]] audit_result audit(const F& film, const P& probe, const audit_options& options = {}, const E& run = {}) {
    const audited_film numbers{film};
    return audit(numbers.view(), probe, options, run);
}

/// Error bars of a film's pixels by an audit of it without classes.
template <Film F>
[[nodiscard]] std::vector<double> error_bars(const F& film, const audit_result& result) {
    const audited_film numbers{film};
    return error_bars(numbers.view(), result);
}

}  // namespace aglow
