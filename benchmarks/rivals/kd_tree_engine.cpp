// Our own tree with the instructions of one machine alone, compiled by that machine's flags: how much of its speed is
// left on older ones. RIVALS_ENGINE is the pack, RIVALS_ENGINE_NAME what the table calls it.
#include <aglow/containers/kd_accept.hpp>
#include <aglow/containers/kd_build.hpp>
#include <aglow/containers/kd_kernels.hpp>

#include "kd_tree_contender.hpp"

namespace rivals {
namespace {

namespace kd = aglow::detail;
using pack = aglow::simd::packs_of<float>::RIVALS_ENGINE;
/// A type of its own, so that no other flags' code stands in for it.
struct runner : kd::kd_pack_runner<pack> {};
struct fetching : aglow::kd_accept_fetching<payload> {
    using kd_accept_fetching::kd_accept_fetching;
};

class engine : public contender {
public:
    [[nodiscard]] std::string name() const override { return RIVALS_ENGINE_NAME; }
    [[nodiscard]] bool is_ours() const override { return true; }

    void build(const std::vector<photon>& photons) override {
        kd::kd_cloud<float> cloud{photons.size()};
        const auto kept = static_cast<std::uint32_t>(kd::take(
            cloud, photons, [](const photon& p) { return p.position; }, aglow::in_sequence{}));
        kd::kd_cloud<float> spare{kept};
        tree_ = {};
        tree_.shape(kept);
        kd::kd_builder<float, runner>{tree_, cloud, spare}.build(aglow::in_sequence{});
        rest_.resize(kept);
        for (std::size_t i = 0; i < rest_.size(); ++i) { rest_[i] = photons[tree_.order[i]].rest; }
    }
    [[nodiscard]] double bytes_per_photon() const override { return 0; }

    double nearest(std::span<const point> queries, std::size_t k) override {
        double sum = 0;
        for (const point& q : queries) { sum += static_cast<double>(k == 1 ? ask_one(q).distance2 : ask(q, k)); }
        return sum;
    }
    double within(std::span<const point> queries, float radius2) override {
        double sum = 0;
        for (const point& q : queries) {
            visit(q, radius2, [&](std::uint32_t, float distance2) { sum += static_cast<double>(distance2); });
        }
        return sum;
    }
    double estimate(std::span<const point> queries, std::size_t k) override {
        double sum = 0;
        const fetching early{rest_};
        for (const point& q : queries) {
            ask(q, k, kd::filter_of<float>(early));
            float light = 0;
            for (std::uint32_t i = 0; i < found_.count; ++i) { light += look_at(rest_[found_.slots[i]]); }
            sum += static_cast<double>(light);
        }
        return sum;
    }

    std::vector<answer> list_nearest(const point& query, std::size_t k) override {
        if (k == 1) {
            const auto one = ask_one(query);
            return {{one.distance2, tree_.order[one.slot]}};
        }
        ask(query, k);
        std::vector<answer> list;
        for (std::uint32_t i = 0; i < found_.count; ++i) {
            list.push_back({found_.distances2[i], tree_.order[found_.slots[i]]});
        }
        return list;
    }
    std::vector<answer> list_within(const point& query, float radius2) override {
        std::vector<answer> list;
        visit(query, radius2, [&](std::uint32_t slot, float d2) { list.push_back({d2, tree_.order[slot]}); });
        return list;
    }

private:
    static constexpr float most = std::numeric_limits<float>::max();

    float ask(const point& q, std::size_t k, const kd::kd_filter<float>& filter = {}) {
        const auto count = static_cast<std::uint32_t>(std::min<std::size_t>(k, tree_.size));
        found_.reserve(2 * std::size_t{count} + 1024);
        probe_.point = q;
        probe_.enough = count;
        return kd::search<runner>(tree_, probe_, kd::kd_task<float>{count, most, 0}, found_, filter);
    }
    kd::kd_best<float> ask_one(const point& q) {
        probe_.point = q;
        probe_.enough = 1;
        probe_.at_home = true;
        return runner::run<kd::nearest_one_kernel>(tree_, probe_, most, filter_);
    }
    template <typename Use>
    void visit(const point& q, float radius2, Use&& use) {
        probe_.point = q;
        probe_.at_home = false;
        probe_.enough = std::numeric_limits<std::uint32_t>::max();
        kd::start(probe_, tree_.height, 0);
        found_.reserve(1024);
        kd::kd_list<float> list{found_.distances2.data(), found_.slots.data(), 0, found_.capacity()};
        while (runner::run<kd::scan_kernel>(tree_, probe_, radius2, list)) {
            for (std::uint32_t i = 0; i < list.count; ++i) { use(list.slots[i], list.distances2[i]); }
            list.count = 0;
        }
    }

    kd::kd_storage<float> tree_;
    std::vector<payload> rest_;
    kd::kd_probe<float> probe_;
    kd::kd_candidates<float> found_;
    kd::kd_filter<float> filter_;
};

}  // namespace

void RIVALS_ENGINE_ADD(contenders& all) { all.push_back(std::make_unique<engine>()); }

}  // namespace rivals
