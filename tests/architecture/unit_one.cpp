// One of two units that include the whole library; unit_two.cpp is the other.
#include "architecture/units.hpp"

namespace architecture {

const void* version_seen_from_one() { return &aglow::version; }

}  // namespace architecture
