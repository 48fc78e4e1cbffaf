#include <aglow/core/lasting.hpp>

#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "support/catch.hpp"

using namespace aglow;

namespace {

struct base {
    virtual ~base() = default;
    int number{7};
};
struct derived : base {};

int number_of(lasting<base> what) { return (*what).number; }

}  // namespace

TEST_CASE("lasting: refers to what it was made of, and not to a copy") {
    std::string name = "room";
    const lasting<std::string> kept{name};
    name = "hall";
    const std::string& read = *kept;
    CHECK(std::addressof(read) == std::addressof(name));
    const derived one;
    CHECK(number_of(one) == 7);
}

TEST_CASE("lasting: takes what has a name, constant or not, and no temporary or what was moved from") {
    CHECK(std::is_convertible_v<std::string&, lasting<std::string>>);
    CHECK(std::is_convertible_v<const std::string&, lasting<std::string>>);
    CHECK(std::is_convertible_v<derived&, lasting<base>>);
    CHECK_FALSE(std::is_constructible_v<lasting<std::string>, std::string>);
    CHECK_FALSE(std::is_constructible_v<lasting<std::string>, const std::string>);
    CHECK_FALSE(std::is_convertible_v<std::string, lasting<std::string>>);
    CHECK_FALSE(std::is_constructible_v<lasting<base>, derived>);
    // Nor one that a conversion would make.
    CHECK_FALSE(std::is_constructible_v<lasting<std::string>, const char*>);
}
