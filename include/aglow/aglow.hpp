// The whole library, bottom to top: the table of contents.
#pragma once

// core: numbers and shapes
#include <aglow/core/bounds.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/halton.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/octahedral.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/random.hpp>
#include <aglow/core/ray.hpp>
#include <aglow/core/roulette.hpp>
#include <aglow/core/sobol.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/core/version.hpp>
#include <aglow/core/warp.hpp>

// concepts: what a host brings
#include <aglow/concepts/intersector.hpp>
#include <aglow/concepts/light.hpp>
#include <aglow/concepts/sampler.hpp>
#include <aglow/concepts/spectrum.hpp>
#include <aglow/concepts/surface.hpp>

// containers: where things are

// estimators: light from what was stored

// algorithms: light on its way

// report: how good is it
