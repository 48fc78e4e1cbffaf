#include <aglow/core/callback.hpp>

#include <functional>
#include <memory>
#include <type_traits>

#include "support/catch.hpp"

using namespace aglow;

namespace {

bool is_half(double x) { return x == 0.5; }

}  // namespace

TEST_CASE("callback: without a callable nobody can be asked") {
    CHECK_FALSE(callback<double>{});
    bool (*nobody)(double) = nullptr;
    CHECK_FALSE(callback<double>{nobody});
    CHECK_FALSE(callback<double>{std::function<bool(double)>{}});
}

TEST_CASE("callback: functions, lambdas and std::function answer as they do alone") {
    const callback<double> plain = is_half;
    const callback<double> wrapped = std::function<bool(double)>{is_half};
    const callback<double> closed = [limit = 0.5](double x) { return x == limit; };
    for (const callback<double>& asked : {plain, wrapped, closed}) {
        REQUIRE(asked);
        CHECK(asked(0.5));
        CHECK_FALSE(asked(0.25));
    }
}

TEST_CASE("callback: a copy shares what the callable holds, and it is freed with the last") {
    auto calls = std::make_shared<int>(0);
    {
        callback<const int&> first = [calls](const int& n) { return (*calls += n) > 2; };
        const callback<const int&> second = first;
        CHECK_FALSE(first(2));
        first = {};
        CHECK_FALSE(first);
        CHECK(second(2));
    }
    CHECK(*calls == 4);
    CHECK(calls.use_count() == 1);
}

TEST_CASE("callback: what cannot be asked is refused") {
    CHECK_FALSE(std::is_constructible_v<callback<double>, int>);
    CHECK_FALSE(std::is_constructible_v<callback<double>, bool (*)(const char*)>);
    struct stage {
        bool done;
    };
    CHECK_FALSE(std::is_constructible_v<callback<const stage&>, bool stage::*>);
}
