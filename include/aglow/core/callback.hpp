// A question that a host may answer or leave open, as progress is: `std::function` without its header.
#pragma once

#include <concepts>
#include <memory>
#include <type_traits>
#include <utility>

namespace aglow {

/// Any callable that answers an `Argument` with yes or no, or none. Copies share what the callable holds.
template <typename Argument>
class callback {
    /// Whether an `F` is called by brackets: `std::predicate` would take members too, which are not.
    template <typename F>
    static constexpr bool answers = requires(F& answer, Argument argument) {
        { answer(argument) } -> std::convertible_to<bool>;
    };

public:
    /// No callable.
    callback() = default;

    /// Takes `answer`, which may itself be empty where it can be: a null pointer or an empty `std::function`.
    template <typename F>
        requires(!std::same_as<std::remove_cvref_t<F>, callback> && answers<std::decay_t<F>>)
    callback(F&& answer) {
        using held = std::decay_t<F>;
        held given(std::forward<F>(answer));
        if constexpr (std::is_pointer_v<held> || requires { given.operator bool(); }) {
            if (!given) { return; }
        }
        held_ = std::make_shared<held>(std::move(given));
        ask_ = [](void* what, Argument argument) -> bool { return (*static_cast<held*>(what))(argument); };
    }

    /// Whether there is somebody to ask.
    explicit operator bool() const { return ask_ != nullptr; }
    /// The answer; yes where there is nobody to ask, who may be asked all the same: a `std::function` that was made of
    /// such a callback does not look empty.
    bool operator()(Argument argument) const { return !ask_ || ask_(held_.get(), argument); }

private:
    std::shared_ptr<void> held_{};
    bool (*ask_)(void*, Argument){nullptr};
};

}  // namespace aglow
