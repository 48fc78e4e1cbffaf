// One who answers: the questions that every kd-tree of the comparison is asked, in its own best way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kd_tree_sets.hpp"

namespace rivals {

/// What a photon carries beside its position: 24 bytes.
struct payload {
    aglow::vec3<float> direction;
    aglow::vec3<float> power;
};

/// A photon as the host stores it: 36 bytes.
struct photon {
    point position;
    payload rest;
};

/// One item of an answer.
struct answer {
    float distance2;
    std::uint32_t index;
};

/// What an estimate does with a photon.
inline float look_at(const payload& p) { return p.direction.z > -2 ? p.power.x + p.power.y + p.power.z : 0.0f; }

class contender {
public:
    virtual ~contender() = default;

    [[nodiscard]] virtual std::string name() const = 0;
    [[nodiscard]] virtual bool is_ours() const { return false; }
    /// Whether it asks another's tree.
    [[nodiscard]] virtual bool borrows() const { return false; }
    /// Builds the tree anew, unless it borrows one; the photons stay until the next.
    virtual void build(const std::vector<photon>& photons) = 0;
    /// Bytes that positions, payload and tree take together, per photon.
    [[nodiscard]] virtual double bytes_per_photon() const = 0;

    // Each returns a sum over all answers, so that none can be left out.
    virtual double nearest(std::span<const point> queries, std::size_t k) = 0;
    virtual double within(std::span<const point> queries, float radius2) = 0;
    /// The k nearest, and a look at the payload of each.
    virtual double estimate(std::span<const point> queries, std::size_t k) = 0;

    /// Answers to one question, for the check.
    virtual std::vector<answer> list_nearest(const point& query, std::size_t k) = 0;
    virtual std::vector<answer> list_within(const point& query, float radius2) = 0;
};

using contenders = std::vector<std::unique_ptr<contender>>;

void add_aglow(contenders& all);
void add_aglow_avx2(contenders& all);
void add_aglow_sse(contenders& all);
void add_nanoflann(contenders& all);
void add_flann(contenders& all);
void add_cgal(contenders& all);

}  // namespace rivals
