// Our own tree, asked in three ways: one query at a time, with the last answer as a hint, and in batches.
#include <aglow/containers/kd_tree.hpp>

#include "kd_tree_contender.hpp"

namespace rivals {
namespace {

enum class way { single, hinted, batched };

/// The tree and, in its order, what the photons carry.
struct map {
    aglow::kd_tree<float> tree;
    std::vector<payload> rest;

    void build(const std::vector<photon>& photons) {
        tree = aglow::kd_tree<float>{photons, &photon::position};
        rest.resize(tree.size());
        for (std::size_t i = 0; i < rest.size(); ++i) { rest[i] = photons[tree.order()[i]].rest; }
    }
    [[nodiscard]] double bytes_per_photon() const {
        const std::size_t bytes = tree.memory() + rest.capacity() * sizeof(payload);
        return static_cast<double>(bytes) / static_cast<double>(tree.size());
    }
};

class ours : public contender {
public:
    ours(way how, std::shared_ptr<map> photons) : how_{how}, map_{std::move(photons)} {}

    [[nodiscard]] std::string name() const override {
        return how_ == way::single ? "aglow" : how_ == way::hinted ? "aglow, hinted" : "aglow, batched";
    }
    [[nodiscard]] bool is_ours() const override { return true; }
    [[nodiscard]] bool borrows() const override { return how_ != way::single; }

    void build(const std::vector<photon>& photons) override {
        if (!borrows()) { map_->build(photons); }
    }
    [[nodiscard]] double bytes_per_photon() const override { return map_->bytes_per_photon(); }

    double nearest(std::span<const point> queries, std::size_t k) override {
        double sum = 0;
        if (k == 1) {
            for (const point& q : queries) { sum += static_cast<double>(map_->tree.nearest_one(q)->distance2); }
            return sum;
        }
        ask(queries, k, [&](const auto& found) { sum += static_cast<double>(found.radius2); });
        return sum;
    }
    double within(std::span<const point> queries, float radius2) override {
        double sum = 0;
        for (const point& q : queries) {
            map_->tree.within(q, radius2,
                              [&](aglow::kd_slot, float distance2) { sum += static_cast<double>(distance2); });
        }
        return sum;
    }
    double estimate(std::span<const point> queries, std::size_t k) override {
        double sum = 0;
        const auto use = [&](const auto& found) {
            float light = 0;
            for (const aglow::kd_slot slot : found.slots) { light += look_at(map_->rest[slot]); }
            sum += static_cast<double>(light);
        };
        ask(queries, k, use, aglow::kd_accept_fetching<payload>{map_->rest});
        return sum;
    }

    std::vector<answer> list_nearest(const point& query, std::size_t k) override {
        std::vector<answer> list;
        if (k == 1) {
            const auto one = map_->tree.nearest_one(query);
            return {{one->distance2, map_->tree.order()[one->slot]}};
        }
        ask({&query, 1}, k, [&](const auto& found) {
            for (std::size_t i = 0; i < found.size(); ++i) {
                list.push_back({found.distances2[i], map_->tree.order()[found.slots[i]]});
            }
        });
        return list;
    }
    std::vector<answer> list_within(const point& query, float radius2) override {
        std::vector<answer> list;
        map_->tree.within(query, radius2, [&](auto slot, float d2) { list.push_back({d2, map_->tree.order()[slot]}); });
        return list;
    }

private:
    template <typename Use, typename Accept = aglow::kd_accept_all>
    void ask(std::span<const point> queries, std::size_t k, Use&& use, Accept accept = {}) {
        if (how_ == way::batched) {
            map_->tree.nearest(
                queries, k, scratch_, {}, [&](std::size_t, const auto& found) { use(found); }, accept);
            return;
        }
        float last2 = 0;
        for (const point& q : queries) {
            const auto found =
                map_->tree.nearest(q, k, scratch_, {.hint2 = how_ == way::hinted ? last2 : 0.0f}, accept);
            last2 = found.radius2;
            use(found);
        }
    }

    way how_;
    std::shared_ptr<map> map_;
    aglow::kd_scratch<float> scratch_;
};

}  // namespace

void add_aglow(contenders& all) {
    const auto photons = std::make_shared<map>();
    for (const way how : {way::single, way::hinted, way::batched}) {
        all.push_back(std::make_unique<ours>(how, photons));
    }
}

}  // namespace rivals
