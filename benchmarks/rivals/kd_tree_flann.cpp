// FLANN: its exact single kd-tree, which keeps its own reordered copy of the positions.
#include <flann/flann.hpp>

#include "kd_tree_contender.hpp"

namespace rivals {
namespace {

using index = flann::KDTreeSingleIndex<flann::L2_Simple<float>>;

class flann_tree : public contender {
public:
    explicit flann_tree(bool heap) : heap_{heap} {}

    [[nodiscard]] std::string name() const override { return heap_ ? "FLANN, heap" : "FLANN"; }

    void build(const std::vector<photon>& photons) override {
        photons_ = &photons;
        rows_.resize(photons.size());
        for (std::size_t i = 0; i < rows_.size(); ++i) { rows_[i] = photons[i].position; }
        const flann::Matrix<float> matrix{&rows_[0].x, rows_.size(), 3};
        index_ = std::make_unique<index>(matrix, flann::KDTreeSingleIndexParams(10, true));
        index_->buildIndex();
    }
    [[nodiscard]] double bytes_per_photon() const override {
        const double rows = sizeof(photon) + sizeof(point);
        return rows + sizeof(point) + static_cast<double>(index_->usedMemory()) / static_cast<double>(rows_.size());
    }

    double nearest(std::span<const point> queries, std::size_t k) override {
        double sum = 0;
        for (const point& q : queries) {
            ask(q, k);
            sum += static_cast<double>(distances2_[k - 1]);
        }
        return sum;
    }
    double within(std::span<const point> queries, float radius2) override {
        double sum = 0;
        for (const point& q : queries) {
            ask_within(q, radius2);
            for (const float d2 : found2_[0]) { sum += static_cast<double>(d2); }
        }
        return sum;
    }
    double estimate(std::span<const point> queries, std::size_t k) override {
        double sum = 0;
        for (const point& q : queries) {
            ask(q, k);
            float light = 0;
            for (const std::size_t i : indices_) { light += look_at((*photons_)[i].rest); }
            sum += static_cast<double>(light);
        }
        return sum;
    }

    std::vector<answer> list_nearest(const point& query, std::size_t k) override {
        ask(query, k);
        std::vector<answer> list(k);
        for (std::size_t i = 0; i < k; ++i) { list[i] = {distances2_[i], static_cast<std::uint32_t>(indices_[i])}; }
        return list;
    }
    std::vector<answer> list_within(const point& query, float radius2) override {
        ask_within(query, radius2);
        std::vector<answer> list(found2_[0].size());
        for (std::size_t i = 0; i < list.size(); ++i) {
            list[i] = {found2_[0][i], static_cast<std::uint32_t>(found_[0][i])};
        }
        return list;
    }

private:
    [[nodiscard]] flann::SearchParams params() const {
        flann::SearchParams p{flann::FLANN_CHECKS_UNLIMITED, 0, false};
        p.use_heap = heap_ ? flann::FLANN_True : flann::FLANN_False;
        return p;
    }
    void ask(const point& q, std::size_t k) {
        indices_.resize(k);
        distances2_.resize(k);
        point copy = q;
        flann::Matrix<std::size_t> indices{indices_.data(), 1, k};
        flann::Matrix<float> distances{distances2_.data(), 1, k};
        index_->knnSearch(flann::Matrix<float>{&copy.x, 1, 3}, indices, distances, k, params());
    }
    void ask_within(const point& q, float radius2) {
        point copy = q;
        index_->radiusSearch(flann::Matrix<float>{&copy.x, 1, 3}, found_, found2_, radius2, params());
    }

    bool heap_;
    const std::vector<photon>* photons_{};
    std::vector<point> rows_;
    std::unique_ptr<index> index_;
    std::vector<std::size_t> indices_;
    std::vector<float> distances2_;
    std::vector<std::vector<std::size_t>> found_;
    std::vector<std::vector<float>> found2_;
};

}  // namespace

void add_flann(contenders& all) {
    all.push_back(std::make_unique<flann_tree>(false));
    all.push_back(std::make_unique<flann_tree>(true));
}

}  // namespace rivals
