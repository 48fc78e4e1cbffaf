// The squared error of a method taken apart: what all its pictures have in common, and what differs from seed to seed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

#include <aglow/report/image_error.hpp>
#include <aglow/report/image_view.hpp>
#include <aglow/report/running_mean.hpp>

namespace aglow {

/// Means over pixels and channels; their sum is the expected relMSE of one picture.
struct error_parts {
    double bias2{0};        ///< (E I − R)² / (R² + ε), below zero by chance where there is none
    double bias2_error{0};  ///< standard error of that, pixels taken as independent
    double variance{0};     ///< Var I / (R² + ε)
    std::size_t pictures{0};
};

/// Collects pictures of one method and budget that differ in their seeds only.
class bias_variance {
public:
    /// Throws `std::invalid_argument` for a picture of another size than those before.
    template <std::floating_point T>
    void add(const image_view<T>& image) {
        require_whole(image, "image");
        if (pictures_ == 0) { values_.resize(image.values.size()); }
        if (values_.size() != image.values.size()) { throw std::invalid_argument("bias_variance: sizes differ"); }
        for (std::size_t i = 0; i < values_.size(); ++i) { values_[i].add(static_cast<double>(image.values[i])); }
        ++pictures_;
    }

    /// Against a reference in two independent halves. Noise of the mean picture and of the halves is taken out of the
    /// bias: (Ī−R1)(Ī−R2) − s²/n. Values that were not finite in any picture or half are left out. Expects two pictures
    /// or more.
    template <std::floating_point T>
    [[nodiscard]] error_parts parts(const image_view<T>& first, const image_view<T>& second,
                                    const image_error_options& options = {}) const {
        require_same_shape(first, second, "second half of the reference");
        if (pictures_ < 2 || first.values.size() != values_.size()) {
            throw std::invalid_argument("bias_variance: fewer than two pictures, or a reference of another size");
        }
        running_mean bias2;
        running_mean variance;
        for (std::size_t i = 0; i < values_.size(); ++i) {
            const double a = static_cast<double>(first.values[i]);
            const double b = static_cast<double>(second.values[i]);
            if (values_[i].rejected() > 0 || !is_finite(a) || !is_finite(b)) { continue; }
            const double below = square(0.5 * a + 0.5 * b) + options.epsilon;
            const double own = values_[i].variance();
            const double product = (values_[i].mean() - a) * (values_[i].mean() - b);
            bias2.add((product - own / static_cast<double>(pictures_)) / below);
            variance.add(own / below);
        }
        return {bias2.mean(), bias2.standard_error(), variance.mean(), pictures_};
    }

private:
    std::vector<running_mean> values_{};
    std::size_t pictures_{0};
};

}  // namespace aglow
