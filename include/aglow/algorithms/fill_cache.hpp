// The pass before the picture: records wherever the picture will ask for them, and nowhere twice.
//
// Candidates are places that the picture will need. Rounds go from coarse to fine spacing: all candidates are looked up
// in parallel, those not covered are thinned to the round's spacing in their fixed order, gathered in parallel, and
// inserted in order. A round leaves uncovered only what needs a finer spacing, so few records overlap more than they
// must, and the records are the same to the last bit for any number of threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include <aglow/algorithms/fill_options.hpp>
#include <aglow/algorithms/gather.hpp>
#include <aglow/algorithms/spaced_places.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/random.hpp>
#include <aglow/estimators/irradiance_cache.hpp>

namespace aglow {

namespace detail {

/// Fills one cache; see `fill_cache`.
template <typename Cache, typename Incoming, typename E>
class cache_filler {
public:
    using T = typename Cache::scalar;
    using S = typename Cache::spectrum;
    using candidate = cache_candidate<T>;
    using estimate = irradiance_estimate<S, T>;

    cache_filler(Cache& cache, std::span<const candidate> candidates, const Incoming& incoming,
                 const fill_cache_options& options, const E& run)
        : cache_{cache},
          candidates_{candidates},
          incoming_{incoming},
          options_{options},
          run_{run},
          estimator_{hemisphere_of(options.rays), parts()},
          taken_(candidates.size()) {}

    template <typename Progress>
    fill_result fill(Progress&& progress) {
        const T wanted = static_cast<T>(options_.minimum_weight);
        pending_ = untaken();
        const auto& reach = cache_.options().reach;
        const T finest = static_cast<T>(reach.minimum_radius / 2) * cache_.scene_radius();
        T spacing = static_cast<T>(reach.maximum_radius) * cache_.scene_radius();
        for (bool last = false; !last && !result_.cancelled; spacing *= static_cast<T>(options_.refinement)) {
            last = spacing <= finest;
            drop_covered(wanted);
            if (pending_.empty() || full()) { break; }
            ++result_.rounds;
            gather(thinned(std::max(spacing, finest)), progress);
        }
        cover_bared(finest, progress);
        drop_covered(wanted);
        result_.uncovered = pending_.size();
        if constexpr (Cache::record::features.noise) { sharpen(progress); }
        return result_;
    }

private:
    static constexpr std::size_t batch = 256;  ///< records from one progress report to the next

    /// A record's number in the cache, and the candidate it was made for.
    struct made_record {
        std::uint32_t record;
        std::size_t candidate;
    };

    [[nodiscard]] estimate_parts parts() const {
        constexpr record_features f = Cache::record::features;
        const error_metric metric = cache_.options().reach.metric;
        return {.gradients = f.gradients || metric != error_metric::nearest_distance,
                .curvature = metric == error_metric::hessian,
                .incident = f.incident};
    }

    /// Adds what no ray brings, where the source of light knows of such.
    void add_unseen(irradiance_estimate<S, T>& to, const gather_point<T>& at) const {
        if constexpr (KnowsUnseen<Incoming, T>) {
            const auto unseen = incoming_.unseen(at);
            const T rays = static_cast<T>(max_component(to.irradiance));
            to.irradiance = to.irradiance + unseen.value;
            const T all = static_cast<T>(max_component(to.irradiance));
            // Errors are two standard deviations or so.
            const T off = static_cast<T>(unseen.error) / 2;
            if (all > 0) { to.relative_noise = std::hypot(to.relative_noise * (rays / all), off / all); }
        }
    }

    [[nodiscard]] bool full() const {
        return options_.maximum_records > 0 && cache_.size() >= options_.maximum_records;
    }

    /// The candidates that no record was made for.
    [[nodiscard]] std::vector<std::size_t> untaken() const {
        std::vector<std::size_t> all;
        for (std::size_t i = 0; i < candidates_.size(); ++i) {
            if (!taken_[i]) { all.push_back(i); }
        }
        return all;
    }

    /// Makes records where no record speaks any more, since those that did were clamped after. What is pending stays
    /// so.
    template <typename Progress>
    void cover_bared(T spacing, Progress& progress) {
        if (result_.cancelled) { return; }
        const std::vector<std::size_t> before = pending_;
        while (true) {
            pending_ = untaken();
            drop_covered(0);
            if (pending_.empty() || full() || result_.cancelled) { break; }
            ++result_.rounds;
            gather(thinned(spacing), progress);
        }
        std::vector<std::size_t> both;
        std::set_union(before.begin(), before.end(), pending_.begin(), pending_.end(), std::back_inserter(both));
        pending_ = std::move(both);
    }

    /// Looks up all that is pending and keeps, in order, what is not covered by more weight than `wanted`.
    void drop_covered(T wanted) {
        std::vector<char> covered(pending_.size());
        for_each_block(run_, pending_.size(), 256, [&](std::size_t, std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const gather_point<T>& p = candidates_[pending_[i]].place;
                covered[i] = cache_.lookup(p.position, p.normal).weight > wanted;
            }
        });
        std::size_t kept = 0;
        for (std::size_t i = 0; i < pending_.size(); ++i) {
            if (!covered[i]) { pending_[kept++] = pending_[i]; }
        }
        pending_.resize(kept);
    }

    /// Takes from the pending ones, in order, each that lies at least `spacing` from those taken before it, unless it
    /// faces another way; the others stay pending.
    [[nodiscard]] std::vector<std::size_t> thinned(T spacing) {
        std::vector<std::size_t> taken;
        std::vector<std::size_t> rest;
        const auto bars = [&](std::size_t other, const gather_point<T>& place) {
            return alike(candidates_[other].place, place, spacing);
        };
        spaced_places<T, decltype(bars)> apart{spacing, bars};
        for (const std::size_t i : pending_) {
            const gather_point<T>& place = candidates_[i].place;
            if (apart.has_room(place) && !full_with(taken.size())) {
                apart.add(i, place);
                taken.push_back(i);
                taken_[i] = 1;
            } else {
                rest.push_back(i);
            }
        }
        pending_ = std::move(rest);
        return taken;
    }

    [[nodiscard]] bool full_with(std::size_t more) const {
        return options_.maximum_records > 0 && cache_.size() + more >= options_.maximum_records;
    }

    /// Whether a record at `a` with that reach would pass the cache's tests of normal and plane at `b`.
    [[nodiscard]] bool alike(const gather_point<T>& a, const gather_point<T>& b, T reach) const {
        const record_lookup_options& lookup = cache_.options().lookup;
        const T turn = length2(a.normal - b.normal) / 2;
        const T height = std::abs(glm::dot(b.position - a.position, a.normal + b.normal)) / 2;
        return turn < static_cast<T>(2 * square(std::sin(lookup.normal_limit / 2))) &&
               height <= static_cast<T>(lookup.plane_tolerance) * reach;
    }

    template <typename Progress>
    void gather(const std::vector<std::size_t>& chosen, Progress& progress) {
        const std::size_t uncovered = chosen.size() + pending_.size();
        const auto place = [&](std::size_t i) { return chosen[i]; };
        const auto insert = [&](std::size_t i, const estimate& e) {
            const record_status status = cache_.insert(e, candidates_[chosen[i]].footprint);
            ++(status == record_status::inserted ? result_.records : result_.refused);
            if (status == record_status::inserted) { made_.push_back({cache_.size() - 1, chosen[i]}); }
        };
        const auto tell = [&](std::size_t) {
            return progress(fill_progress{result_.records, candidates_.size(), uncovered});
        };
        estimate_each(chosen.size(), place, estimator_, 0, insert, tell);
    }

    /// Gathers at the candidates `place(i)` in parallel, and hands on what comes of it in order of i while others are
    /// still gathered: `keep(i, estimate)`. Between batches `tell(done)` may say to stop.
    template <typename Place, typename Keep, typename Tell>
    void estimate_each(std::size_t count, const Place& place, const irradiance_estimator<T>& estimator,
                       std::uint64_t pass, const Keep& keep, const Tell& tell) {
        std::atomic<bool> stop{result_.cancelled};
        const auto make = [&](std::size_t i) {
            return stop ? estimate{} : estimate_at(candidates_[place(i)], estimator, pass);
        };
        const auto take = [&](std::size_t i, const estimate& e) {
            if (stop) { return; }
            result_.rays += e.rays;
            result_.rejected += e.rejected;
            keep(i, e);
            const std::size_t done = i + 1;
            if (done % batch == 0 || done == count) { stop = !tell(done); }
        };
        make_and_take(run_, count, make, take);
        result_.cancelled = stop;
    }

    [[nodiscard]] estimate estimate_at(const candidate& c, const irradiance_estimator<T>& estimator,
                                       std::uint64_t pass) const {
        gather_workspace<S, T> workspace;
        const random_numbers<T> numbers{{options_.seed, pass, c.key}};
        estimate e = gather_irradiance(incoming_, c.place, numbers, estimator, workspace);
        add_unseen(e, c.place);
        return e;
    }

    /// Gathers anew, with more rays, where those around scatter.
    template <typename Progress>
    void sharpen(Progress& progress) {
        if (!(options_.scatter > 0) || result_.cancelled) { return; }
        std::vector<T> scatter(made_.size());
        for_each_block(run_, made_.size(), 64, [&](std::size_t, std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) { scatter[i] = cache_.scatter_around(made_[i].record); }
        });
        // Between the geometric means of the numbers of rays there are.
        const double enough = std::max(options_.scatter, options_.noise * std::sqrt(options_.rays));
        const T some = static_cast<T>(enough * std::sqrt(2.0));
        std::vector<made_record> fourfold;
        std::vector<made_record> sixteenfold;
        for (std::size_t i = 0; i < made_.size(); ++i) {
            if (scatter[i] >= some) { (scatter[i] < 2 * some ? fourfold : sixteenfold).push_back(made_[i]); }
        }
        to_sharpen_ = 4 * fourfold.size() + 16 * sixteenfold.size();
        replace(fourfold, 4, progress);
        replace(sixteenfold, 16, progress);
    }

    template <typename Progress>
    void replace(std::span<const made_record> chosen, std::uint32_t times, Progress& progress) {
        const irradiance_estimator<T> finer{hemisphere_of(times * options_.rays), parts()};
        const auto place = [&](std::size_t i) { return chosen[i].candidate; };
        const auto put = [&](std::size_t i, const estimate& e) { (void)cache_.replace(chosen[i].record, e); };
        const std::size_t before = sharpened_;
        const auto tell = [&](std::size_t done) {
            sharpened_ = before + done * times;
            const double share = static_cast<double>(sharpened_) / static_cast<double>(to_sharpen_);
            return progress(fill_progress{result_.records, candidates_.size(), pending_.size(), share});
        };
        estimate_each(chosen.size(), place, finer, times, put, tell);
    }

    Cache& cache_;
    std::span<const candidate> candidates_;
    const Incoming& incoming_;
    const fill_cache_options& options_;
    const E& run_;
    irradiance_estimator<T> estimator_;
    std::vector<std::size_t> pending_;
    std::vector<char> taken_;  ///< by candidate: whether a record was made for it, good or not
    std::vector<made_record> made_;
    std::size_t to_sharpen_{0};  ///< rays wanted for records gathered anew, in units of `options_.rays`
    std::size_t sharpened_{0};
    fill_result result_;
};

struct go_on {
    bool operator()(const fill_progress&) const { return true; }
};

}  // namespace detail

/// Adds records to `cache` until all `candidates` are covered. Candidates are considered in the given order; `incoming`
/// answers gather rays (see `IncomingLight`, `KnowsUnseen`) and must not ask `cache`, which grows meanwhile.
/// `progress(fill_progress)`, told from any thread, one call at a time, may return false to stop early: what was
/// inserted stays. Throws `std::invalid_argument` for options that make no sense.
template <Spectrum S, std::floating_point T, record_features F, IncomingLight<T, random_numbers<T>> Incoming,
          Executor E = in_sequence, std::predicate<const fill_progress&> Progress = detail::go_on>
fill_result fill_cache(irradiance_cache<S, T, F>& cache,
                       std::span<const cache_candidate<std::type_identity_t<T>>> candidates, const Incoming& incoming,
                       const fill_cache_options& options = {}, const E& run = {}, Progress&& progress = {}) {
    detail::check(options);
    detail::cache_filler<irradiance_cache<S, T, F>, Incoming, E> filler{cache, candidates, incoming, options, run};
    return filler.fill(progress);
}

}  // namespace aglow
