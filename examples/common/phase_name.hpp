// What is made before a picture, in words.
#pragma once

#include <string>

#include <aglow/algorithms/preparation.hpp>

namespace host {

/// What people call a phase.
[[nodiscard]] inline std::string name_of(aglow::preparation_phase phase) {
    switch (phase) {
        case aglow::preparation_phase::photons: return "photons";
        case aglow::preparation_phase::irradiance: return "irradiance at photons";
        case aglow::preparation_phase::places: return "places for records";
        case aglow::preparation_phase::records: break;
    }
    return "irradiance cache";
}

}  // namespace host
