#include <aglow/report/audited_film.hpp>

#include <array>
#include <cstddef>
#include <type_traits>
#include <vector>

#include <glm/vec3.hpp>

#include <aglow/algorithms/film.hpp>

#include "report/synthetic.hpp"
#include "support/catch.hpp"

using namespace aglow;
using synthetic::damage;
using synthetic::field;

namespace {

/// Two rows of three pixels, each of whose numbers tells where it is from.
template <typename Colour>
struct numbered {
    static std::size_t width() { return 3; }
    static std::size_t height() { return 2; }
    Colour radiance(std::size_t x, std::size_t y) const {
        const float at = static_cast<float>(10 * y + x);
        if constexpr (std::is_same_v<Colour, float>) {
            return at;
        } else {
            return {at, at + 0.25f, at + 0.5f};
        }
    }
    float error(std::size_t x, std::size_t y) const { return static_cast<float>(x + y) / 8; }
};

/// A field as a film.
struct field_film {
    const field& f;
    static std::size_t width() { return field::side; }
    static std::size_t height() { return field::side; }
    double radiance(std::size_t x, std::size_t y) const { return f.picture[y * field::side + x]; }
    double error(std::size_t x, std::size_t y) const { return f.guess[y * field::side + x]; }
};

struct host_colour {
    float red, rest;
};

}  // namespace

TEST_CASE("audited_film: a colour is a number, a vector or an array, row by row from the top") {
    const auto three = [](const auto& film) {
        const audited_film numbers{film};
        const auto view = numbers.view();
        REQUIRE(view.image.values.size() == 18);
        CHECK((view.image.width == 3 && view.image.height == 2 && view.image.channels == 3));
        CHECK(view.image.at(0, 2) == 0.5);
        CHECK(view.image.at(5, 1) == 12.25);
        CHECK(view.guess[5] == 0.375f);
        CHECK(view.classes.empty());
    };
    three(numbered<glm::vec3>{});
    three(numbered<std::array<float, 3>>{});
    const audited_film gray{numbered<float>{}};
    CHECK(gray.view().image.channels == 1);
    CHECK(gray.values() == std::vector<float>{0, 1, 2, 10, 11, 12});
}

TEST_CASE("audited_film: a colour of the host's own comes through its own channels") {
    struct own_film : numbered<float> {
        host_colour radiance(std::size_t x, std::size_t) const { return {1, static_cast<float>(x)}; }
    };
    const audited_film numbers{own_film{}, [](const host_colour& c) { return std::array{c.red, c.rest}; }};
    CHECK(numbers.values() == std::vector<float>{1, 0, 1, 1, 1, 2, 1, 0, 1, 1, 1, 2});
    CHECK(numbers.view().image.channels == 2);
}

TEST_CASE("audited_film: an audit of a film says what one of its numbers and guesses says, to the bit") {
    const field f{damage::edges};
    const audit_options options{.target = 0.05, .seed = 3};
    const audited_picture<double> by_hand{.image = f.image(), .guess = f.guess};
    const audit_result expected = audit(by_hand, f.probe(), options);
    const field_film film{f};
    const audit_result said = audit(film, f.probe(), options);
    CHECK(said.mean_error_bound == expected.mean_error_bound);
    CHECK(said.energy_bias.low == expected.energy_bias.low);
    CHECK(said.samples == expected.samples);
    CHECK(error_bars(film, said) == error_bars(by_hand, expected));
    // With classes, bars hold in each.
    const audited_film numbers{film};
    CHECK(audit(numbers.view(f.classes), f.probe(), options).scales.size() == 2);
}

TEST_CASE("audited_film: the library's film is one, in gray and in colour") {
    CHECK(Film<film<float>>);
    CHECK(Film<film<glm::vec3>>);
    CHECK_FALSE(Film<audited_film<float>>);
    CHECK_FALSE(Film<image_view<float>>);
    const film<glm::vec3> dark{4, 2};
    CHECK(audited_film{dark}.values() == std::vector<float>(24, 0.0f));
}
