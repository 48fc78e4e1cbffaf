// What a study was made with.
#pragma once

#include <cstddef>
#include <string>

#include "error_vs_time/study.hpp"

namespace error_vs_time {

/// Library, commit, compiler, flags, processor, seeds, size; and when, beside how much else the machine did.
[[nodiscard]] text_pairs provenance(std::size_t seeds, std::size_t size, std::size_t reference_samples);

/// Whether runs of one study may stand for runs of the other: all the same but for when.
[[nodiscard]] bool same_making(const text_pairs& a, const text_pairs& b);

}  // namespace error_vs_time
