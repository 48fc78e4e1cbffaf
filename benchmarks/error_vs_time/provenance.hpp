// What a study was made with.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "error_vs_time/options.hpp"
#include "error_vs_time/study.hpp"

namespace error_vs_time {

/// Library, commit, compiler, flags, processor, seeds, size; and when and by which command, beside how much else the
/// machine did.
[[nodiscard]] text_pairs provenance(const options& asked, const std::vector<std::string_view>& words);

/// Whether runs of one study may stand for runs of the other: all the same but for when and by which command.
[[nodiscard]] bool same_making(const text_pairs& a, const text_pairs& b);

}  // namespace error_vs_time
