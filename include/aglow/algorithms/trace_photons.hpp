// Photon maps from a scene and its lights: direct, caustic and indirect light, each with its own number of photons.
//
// Jensen 1996. How many paths a map needs is found by a pilot whose photons are thrown away, so the number is fixed
// before the first photon is stored and the estimate stays unbiased (storing until full is k/(k-1) too bright). The
// pilot also finds how much of the light is indirect, and so how much its map's noise matters.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <aglow/algorithms/photon_demand.hpp>
#include <aglow/algorithms/photon_options.hpp>
#include <aglow/algorithms/photon_walk.hpp>
#include <aglow/core/halton.hpp>
#include <aglow/core/parallel.hpp>

namespace aglow {

namespace detail {

/// What one block of consecutive paths brought home, by history.
template <Spectrum S, std::floating_point T>
struct photon_block {
    std::array<std::vector<landed_photon<S, T>>, 4> landed{};
    std::array<std::size_t, 4> counts{};
    std::array<std::size_t, 4> paths{};  ///< walked here that could have stored photons of each history
    std::array<double, 4> flux{};        ///< stored power; its squares path by path tell how sure the whole is
    std::array<double, 4> flux2{};       ///< (photons of one path are no independent witnesses)
    std::array<double, 4> met{};         ///< by a pilot: power of all that landed, wanted or not
    energy_ledger<S> ledger{};
};

/// Traces the photons of one call of `trace_photons`, step by step.
template <Scene World, Emitter Lights, Executor Run>
class photon_tracer {
    using S = spectrum_of<World>;
    using T = scalar_of<World>;
    using kinds = std::array<std::size_t, 4>;
    using blocks_type = std::vector<photon_block<S, T>>;
    static constexpr std::size_t block_size = 1024;

public:
    photon_tracer(const World& scene, const Lights& lights, const photon_options& options, const Run& run)
        : scene_{scene},
          lights_{lights},
          options_{options},
          run_{run},
          demand_{options},
          most_bounces_{options.most_bounces} {
        if (options.pilot_paths == 0) { throw std::invalid_argument("photon_options.pilot_paths must not be 0"); }
    }

    [[nodiscard]] photon_maps<S, T> maps() {
        plan();
        photon_maps<S, T> result;
        const auto blocks = trace(paths_, options_.pass);
        std::vector<energy_ledger<S>> ledgers;
        for (const auto& block : blocks) { ledgers.push_back(block.ledger); }
        result.ledger = joined<S>(ledgers);
        result.most_bounces = most_bounces_;
        finish(result.direct, blocks, photon_history::direct, complaint(result.ledger));
        finish(result.caustic, blocks, photon_history::caustic, complaint(result.ledger));
        finish(result.indirect, blocks, photon_history::indirect, complaint(result.ledger));
        finish(result.reflected, blocks, photon_history::reflected, complaint(result.ledger));
        return result;
    }

private:
    static constexpr std::size_t index(photon_history h) { return static_cast<std::size_t>(h); }

    /// Where photons of such a history go: caustic ones that have no map of their own are not lost.
    [[nodiscard]] std::size_t map_of(photon_history h) const {
        const bool homeless = h == photon_history::caustic && options_.caustic == 0;
        return index(homeless || h == photon_history::reflected ? photon_history::indirect : h);
    }

    void plan() {
        wanted_ = {options_.direct, options_.caustic, options_.indirect, options_.reflected};
        const lobe_set lobes = possible_lobes(scene_);
        if (!any(lobes, lobe_set::specular)) { leave_out(photon_history::caustic, "left out, no specular surface"); }
        if (wanted_[index(photon_history::caustic)] == 0) {
            leave_out(photon_history::reflected, "left out, no caustic map");
        }
        if (!any(lobes, lobe_set::smooth)) {
            for (std::size_t kind = 0; kind < 4; ++kind) {
                leave_out(static_cast<photon_history>(kind), "left out, no diffuse or glossy surface");
            }
        }
        take_given_paths();
        find_paths();
    }

    void leave_out(photon_history kind, const char* why) {
        if (wanted_[index(kind)] == 0) { return; }
        wanted_[index(kind)] = 0;
        why_[index(kind)] = why;
    }

    void take_given_paths() {
        const kinds given{options_.paths.direct, options_.paths.caustic, options_.paths.indirect,
                          options_.paths.reflected};
        for (std::size_t kind = 0; kind < 4; ++kind) {
            if (wanted_[kind] != 0) { paths_[kind] = std::min(given[kind], options_.most_paths); }
        }
    }

    /// Asks a pilot how many paths the maps need that were not told.
    void find_paths() {
        kinds unknown{};
        for (std::size_t kind = 0; kind < 4; ++kind) {
            unknown[kind] = wanted_[kind] != 0 && paths_[kind] == 0 ? options_.pilot_paths : 0;
        }
        if (unknown == kinds{}) { return; }
        const kinds found = pilot(unknown);
        for (std::size_t kind = 0; kind < 4; ++kind) {
            if (unknown[kind] == 0) { continue; }
            share_[kind] = demand_.share_of_light(static_cast<photon_history>(kind));
            paths_[kind] = demand_.paths_worth(wanted_[kind], found[kind], share_[kind]);
        }
    }

    /// How many photons of each kind the pilot's paths would have stored. Paths that do not end within sight are cut
    /// here, where no power is at stake, and there only if most do not end.
    [[nodiscard]] kinds pilot(const kinds& paths) {
        piloting_ = true;
        if (options_.most_bounces == 0) { most_bounces_ = endless_bounces; }
        const auto blocks = trace(paths, ~options_.pass);
        piloting_ = false;
        kinds found{};
        energy_ledger<S> ledger;
        for (const auto& block : blocks) {
            ledger += block.ledger;
            for (std::size_t kind = 0; kind < 4; ++kind) {
                found[kind] += block.counts[kind];
                demand_.met[kind] += block.met[kind];
            }
        }
        demand_.endless = options_.most_bounces == 0 && 2 * ledger.capped > ledger.emitted;
        if (!demand_.endless) { most_bounces_ = options_.most_bounces; }
        return found;
    }

    [[nodiscard]] blocks_type trace(const kinds& paths, std::uint64_t pass) {
        const std::size_t count = *std::max_element(paths.begin(), paths.end());
        blocks_type blocks((count + block_size - 1) / block_size);
        if (count == 0) { return blocks; }
        std::atomic<std::size_t> done{0};
        const halton_scrambling table{options_.seed, pass};
        for_each_block(run_, count, block_size, [&](std::size_t b, std::size_t first, std::size_t last) {
            if (stopped_) { return; }
            blocks[b].ledger = kept_books<S>(first, last, [&](std::size_t i, energy_ledger<S>& ledger) {
                trace_path(halton_numbers<T>{table, i}, i, paths, blocks[b], ledger);
            });
            if (piloting_ || !options_.progress) { return; }
            const std::size_t so_far = done += last - first;
            if (!options_.progress(static_cast<double>(so_far) / static_cast<double>(count))) { stopped_ = true; }
        });
        return blocks;
    }

    void trace_path(const halton_numbers<T>& numbers, std::size_t i, const kinds& paths, photon_block<S, T>& into,
                    energy_ledger<S>& ledger) {
        for (std::size_t kind = 0; kind < 4; ++kind) { into.paths[kind] += i < paths[kind] ? 1 : 0; }
        const std::array<double, 4> before = into.flux;
        walk_photon(scene_, lights_, numbers, most_bounces_, ledger,
                    [&](const auto& hit, const vec3<T>& wi, const S& power, photon_history history) {
                        const std::size_t kind = map_of(history);
                        if (piloting_ && is_radiance(power)) { meet(power, kind, history, into); }
                        if (i < paths[kind]) { store(hit, wi, power, into, kind); }
                        if (history == photon_history::reflected && i < paths[index(history)]) {
                            store(hit, wi, power, into, index(history));
                        }
                        return is_wanted_after(history, any(hit.lobes(), lobe_set::specular), i, paths);
                    });
        for (std::size_t kind = 0; kind < 4; ++kind) { into.flux2[kind] += square(into.flux[kind] - before[kind]); }
    }

    /// Light that lands counts for its share whether its own map wants it or not.
    static void meet(const S& power, std::size_t kind, photon_history history, photon_block<S, T>& into) {
        const double flux = static_cast<double>(max_component(power));
        into.met[kind] += flux;
        if (history == photon_history::reflected) { into.met[index(history)] += flux; }
    }

    /// Whether some map may still store what goes on from a surface that path `i` came to with `history`.
    [[nodiscard]] static bool is_wanted_after(photon_history history, bool mirrors, std::size_t i, const kinds& paths) {
        if (i < paths[index(photon_history::indirect)]) { return true; }
        const bool unscattered = history == photon_history::direct || history == photon_history::caustic;
        if (unscattered && mirrors && i < paths[index(photon_history::caustic)]) { return true; }
        const bool to_reflect = history == photon_history::caustic || (history != photon_history::indirect && mirrors);
        return to_reflect && i < paths[index(photon_history::reflected)];
    }

    template <typename H>
    void store(const H& hit, const vec3<T>& wi, const S& power, photon_block<S, T>& into, std::size_t kind) {
        ++into.counts[kind];
        if (piloting_) { return; }
        if (is_radiance(power)) { into.flux[kind] += static_cast<double>(max_component(power)); }
        const vec3<T> n = hit.normal;
        const vec3<T> side = glm::dot(n, wi) < 0 ? -n : n;
        into.landed[kind].push_back(
            {hit.position, {power, packed_direction<std::int16_t>{wi}, packed_direction<std::int16_t>{side}}});
    }

    void finish(traced_map<S, T>& map, const blocks_type& blocks, photon_history kind, const std::string& wrong) {
        const std::size_t k = index(kind);
        std::size_t count = 0;
        double flux = 0;
        double flux2 = 0;
        for (const auto& block : blocks) {
            count += block.landed[k].size();
            map.paths += block.paths[k];
            flux += block.flux[k];
            flux2 += block.flux2[k];
        }
        std::vector<landed_photon<S, T>> photons;
        photons.reserve(count);
        for (const auto& block : blocks) {
            photons.insert(photons.end(), block.landed[k].begin(), block.landed[k].end());
        }
        const T scale = map.paths == 0 ? T(0) : T(1) / static_cast<T>(map.paths);
        static_cast<photon_map<S, T>&>(map) = photon_map<S, T>{photons, scale, run_};
        if (flux > 0) {
            map.common = detail::shared_noise(static_cast<double>(map.paths), flux, flux2);
            map.come_in_bunches(static_cast<double>(map.size()) * square(map.common));
        }
        map.wanted = wanted_[k];
        map.why = why_[k];
        describe(map, kind, wrong);
    }

    void describe(traced_map<S, T>& map, photon_history kind, const std::string& wrong) const {
        if (map.wanted == 0) { return; }
        const auto tell = [&](map_status status, std::string why) {
            map.status = status;
            map.why = std::move(why) + wrong;
        };
        const std::string paths = std::to_string(map.paths) + " paths";
        if (map.empty()) { return tell(map_status::empty, "empty, nothing landed in " + paths); }
        if (stopped_) { return tell(map_status::partly, "partly filled, stopped after " + paths); }
        // The pilot's guess is off by a few per cent, and counts by their chance; less than that is no news.
        const double missing = static_cast<double>(map.wanted) - static_cast<double>(map.size());
        const double expected = static_cast<double>(map.wanted);
        if (missing > expected / 10 + 4 * std::sqrt(expected)) {
            const bool spared = demand_.is_spared(share_[index(kind)]) && map.paths < options_.most_paths;
            return tell(map_status::partly, "partly filled, " + (spared ? rarity(kind) : "all " + paths + " used up"));
        }
        tell(map_status::full, "full");
    }

    /// Why more photons of a kind were not sought.
    [[nodiscard]] std::string rarity(photon_history kind) const {
        const auto times = static_cast<std::size_t>(1 / share_[index(kind)]);
        return "one part in " + std::to_string(times) + " of the light is not worth more paths";
    }

    const World& scene_;
    const Lights& lights_;
    const photon_options& options_;
    const Run& run_;
    kinds wanted_{};
    kinds paths_{};
    photon_demand demand_;
    std::array<double, 4> share_{1, 1, 1, 1};  ///< of the light, of maps that a pilot was asked about
    std::array<std::string, 4> why_{};
    std::uint32_t most_bounces_;
    bool piloting_{false};
    std::atomic<bool> stopped_{false};
};

}  // namespace detail

/// Sends particles from `lights` through `scene` and stores them where they land.
///
/// A map holds the photons of its first `paths` paths, and every path has its own fixed numbers: the same maps for any
/// number of threads. Photons with NaN, infinite or negative power are dropped and counted in the ledger. Never
/// endless: a map that can hold nothing ends `empty` or `left_out` and says why. Stopped early, the maps hold what was
/// found until then, with the power of as many paths as were walked. Throws `std::invalid_argument` for an empty pilot.
template <Scene World, Emitter Lights, Executor Run = in_sequence>
[[nodiscard]] auto trace_photons(const World& scene, const Lights& lights, const photon_options& options = {},
                                 const Run& run = {}) {
    return detail::photon_tracer<World, Lights, Run>{scene, lights, options, run}.maps();
}

}  // namespace aglow
