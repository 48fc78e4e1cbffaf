// The other of two units that include the whole library, and the test that they link to one program.
#include "architecture/units.hpp"
#include "support/catch.hpp"

TEST_CASE("units: two that include everything link, and share what is in line") {
    CHECK(architecture::version_seen_from_one() == &aglow::version);
}
