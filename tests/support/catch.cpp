// Gives the precompiled Catch2 a program to belong to.
#include "support/catch.hpp"
