// A parameter for what is kept by reference: it takes what has a name, and refuses temporaries.
#pragma once

namespace aglow {

/// A reference to something of the caller's that must live longer than what is made of it. Made of an lvalue without a
/// word; what would be gone at the end of the line does not compile.
template <typename T>
class lasting {
public:
    lasting(const T& what) : what_{what} {}
    lasting(const T&&) = delete;

    const T& operator*() const { return what_; }

private:
    const T& what_;
};

}  // namespace aglow
