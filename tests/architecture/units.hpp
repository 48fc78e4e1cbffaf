// What the two units that include the whole library know of each other.
#pragma once

#include <aglow/aglow.hpp>

namespace architecture {

/// The address of `aglow::version` in the other unit.
const void* version_seen_from_one();

}  // namespace architecture
