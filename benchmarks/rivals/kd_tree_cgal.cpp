// CGAL: its two exact orthogonal searches, over points that carry their index.
#include <CGAL/Fuzzy_sphere.h>
#include <CGAL/Kd_tree.h>
#include <CGAL/Orthogonal_incremental_neighbor_search.h>
#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <iterator>
#include <utility>

#include "kd_tree_contender.hpp"

namespace rivals {
namespace {

using kernel = CGAL::Simple_cartesian<float>;
using place = kernel::Point_3;
using item = std::pair<place, std::uint32_t>;
using places = CGAL::First_of_pair_property_map<item>;
using base = CGAL::Search_traits_3<kernel>;
using traits = CGAL::Search_traits_adapter<item, places, base>;
using distance = CGAL::Distance_adapter<item, places, CGAL::Euclidean_distance<base>>;
using splitter = CGAL::Sliding_midpoint<traits>;
using tree = CGAL::Kd_tree<traits, splitter, CGAL::Tag_true, CGAL::Tag_true>;
using all_at_once = CGAL::Orthogonal_k_neighbor_search<traits, distance, splitter, tree>;
using one_by_one = CGAL::Orthogonal_incremental_neighbor_search<traits, distance, splitter, tree>;
using sphere = CGAL::Fuzzy_sphere<traits>;

place as_place(const point& p) { return {p.x, p.y, p.z}; }

float squared(const place& a, const point& b) { return aglow::distance2(aglow::vec3<float>(a.x(), a.y(), a.z()), b); }

class cgal_tree : public contender {
public:
    explicit cgal_tree(bool incremental) : incremental_{incremental} {}

    [[nodiscard]] std::string name() const override { return incremental_ ? "CGAL, incremental" : "CGAL"; }

    void build(const std::vector<photon>& photons) override {
        photons_ = &photons;
        std::vector<item> items;
        items.reserve(photons.size());
        for (std::uint32_t i = 0; i < photons.size(); ++i) { items.emplace_back(as_place(photons[i].position), i); }
        tree_ = std::make_unique<tree>(items.begin(), items.end());
        tree_->build();
    }
    /// 36 of the host, 16 of the item, 8 of the pointer to it, 12 of the cache, and nodes of about 10 points.
    [[nodiscard]] double bytes_per_photon() const override { return 36 + 16 + 8 + 12 + 64.0 / 6; }

    double nearest(std::span<const point> queries, std::size_t k) override {
        double sum = 0;
        for (const point& q : queries) {
            float farthest = 0;
            ask(q, k, [&](std::uint32_t, float d2) { farthest = std::max(farthest, d2); });
            sum += static_cast<double>(farthest);
        }
        return sum;
    }
    double within(std::span<const point> queries, float radius2) override {
        double sum = 0;
        for (const point& q : queries) {
            ask_within(q, radius2);
            for (const item& found : found_) { sum += static_cast<double>(squared(found.first, q)); }
        }
        return sum;
    }
    double estimate(std::span<const point> queries, std::size_t k) override {
        double sum = 0;
        for (const point& q : queries) {
            float light = 0;
            ask(q, k, [&](std::uint32_t i, float) { light += look_at((*photons_)[i].rest); });
            sum += static_cast<double>(light);
        }
        return sum;
    }

    std::vector<answer> list_nearest(const point& query, std::size_t k) override {
        std::vector<answer> list;
        ask(query, k, [&](std::uint32_t i, float d2) { list.push_back({d2, i}); });
        return list;
    }
    std::vector<answer> list_within(const point& query, float radius2) override {
        ask_within(query, radius2);
        std::vector<answer> list;
        for (const item& found : found_) { list.push_back({squared(found.first, query), found.second}); }
        return list;
    }

private:
    template <typename Use>
    void ask(const point& q, std::size_t k, Use&& use) {
        if (incremental_) {
            one_by_one search{*tree_, as_place(q)};
            auto at = search.begin();
            for (std::size_t i = 0; i < k; ++i, ++at) { use(at->first.second, at->second); }
            return;
        }
        const all_at_once search{*tree_, as_place(q), static_cast<unsigned>(k), 0, true, distance{}, false};
        for (const auto& [found, d2] : search) { use(found.second, d2); }
    }
    void ask_within(const point& q, float radius2) {
        found_.clear();
        tree_->search(std::back_inserter(found_), sphere{as_place(q), std::sqrt(radius2), 0});
    }

    bool incremental_;
    const std::vector<photon>* photons_{};
    std::unique_ptr<tree> tree_;
    std::vector<item> found_;
};

}  // namespace

void add_cgal(contenders& all) {
    all.push_back(std::make_unique<cgal_tree>(false));
    all.push_back(std::make_unique<cgal_tree>(true));
}

}  // namespace rivals
