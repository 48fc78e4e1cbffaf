// The whole library, bottom to top: the table of contents.
#pragma once

// core: numbers and shapes
#include <aglow/core/bounds.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/core/version.hpp>

// concepts: what a host brings

// containers: where things are

// estimators: light from what was stored

// algorithms: light on its way

// report: how good is it
