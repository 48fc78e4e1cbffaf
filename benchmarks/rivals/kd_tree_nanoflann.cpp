// nanoflann: its adaptor over the host's own photons, as its examples use it.
#include <nanoflann.hpp>

#include "kd_tree_contender.hpp"

namespace rivals {
namespace {

struct adaptor {
    const std::vector<photon>* photons;
    [[nodiscard]] std::size_t kdtree_get_point_count() const { return photons->size(); }
    [[nodiscard]] float kdtree_get_pt(std::size_t i, std::size_t axis) const {
        return (*photons)[i].position[static_cast<int>(axis)];
    }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

using index =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, adaptor>, adaptor, 3, std::uint32_t>;

class nano : public contender {
public:
    [[nodiscard]] std::string name() const override { return "nanoflann"; }

    void build(const std::vector<photon>& photons) override {
        adaptor_.photons = &photons;
        index_ = std::make_unique<index>(3, adaptor_, nanoflann::KDTreeSingleIndexAdaptorParams(10));
        index_->buildIndex();
    }
    [[nodiscard]] double bytes_per_photon() const override {
        const auto count = static_cast<double>(adaptor_.photons->size());
        return sizeof(photon) + static_cast<double>(index_->usedMemory(*index_)) / count;
    }

    double nearest(std::span<const point> queries, std::size_t k) override {
        double sum = 0;
        for (const point& q : queries) { sum += static_cast<double>(distances2_[ask(q, k) - 1]); }
        return sum;
    }
    double within(std::span<const point> queries, float radius2) override {
        double sum = 0;
        for (const point& q : queries) {
            for (const auto& found : ask_within(q, radius2)) { sum += static_cast<double>(found.second); }
        }
        return sum;
    }
    double estimate(std::span<const point> queries, std::size_t k) override {
        double sum = 0;
        for (const point& q : queries) {
            const std::size_t count = ask(q, k);
            float light = 0;
            for (std::size_t i = 0; i < count; ++i) { light += look_at((*adaptor_.photons)[indices_[i]].rest); }
            sum += static_cast<double>(light);
        }
        return sum;
    }

    std::vector<answer> list_nearest(const point& query, std::size_t k) override {
        std::vector<answer> list(ask(query, k));
        for (std::size_t i = 0; i < list.size(); ++i) { list[i] = {distances2_[i], indices_[i]}; }
        return list;
    }
    std::vector<answer> list_within(const point& query, float radius2) override {
        std::vector<answer> list;
        for (const auto& found : ask_within(query, radius2)) { list.push_back({found.second, found.first}); }
        return list;
    }

private:
    std::size_t ask(const point& q, std::size_t k) {
        indices_.resize(k);
        distances2_.resize(k);
        nanoflann::KNNResultSet<float, std::uint32_t> result(k);
        result.init(indices_.data(), distances2_.data());
        index_->findNeighbors(result, &q.x, nanoflann::SearchParams());
        return result.size();
    }
    const std::vector<std::pair<std::uint32_t, float>>& ask_within(const point& q, float radius2) {
        found_.clear();
        nanoflann::RadiusResultSet<float, std::uint32_t> result(radius2, found_);
        index_->findNeighbors(result, &q.x, nanoflann::SearchParams(32, 0, false));
        return found_;
    }

    adaptor adaptor_{};
    std::unique_ptr<index> index_;
    std::vector<std::uint32_t> indices_;
    std::vector<float> distances2_;
    std::vector<std::pair<std::uint32_t, float>> found_;
};

}  // namespace

void add_nanoflann(contenders& all) { all.push_back(std::make_unique<nano>()); }

}  // namespace rivals
