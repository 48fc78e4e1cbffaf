// A wrong wish: told in one line, and the program ends with status 2.
#pragma once

#include <stdexcept>

namespace host {

struct usage_error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace host
