#include "error_vs_time/study.hpp"

#include <algorithm>

namespace error_vs_time {

const std::vector<metric>& metrics() {
    using aglow::image_error;
    static const std::vector<metric> all{
        {"MAPE", "mean |I−R| / (|R| + 0.02 mean R)", &image_error::mape, false, {0.10, 0.05, 0.02, 0.01}},
        {"relMSE", "mean (I−R)² / (R² + 0.01)", &image_error::relmse, true, {}},
        {"relMSE, trimmed", "relMSE without the largest 0.1 %", &image_error::relmse_trimmed, true, {}},
        {"SMAPE", "mean 2|I−R| / (|I| + |R| + 0.04 mean R)", &image_error::smape, false, {}},
        {"RMSE", "√ mean (I−R)²", &image_error::rmse, false, {}},
        {"95 % quantile", "of |I−R| / (|R| + 0.02 mean R)", &image_error::relative_q95, false, {}},
        {"99 % quantile", "of |I−R| / (|R| + 0.02 mean R)", &image_error::relative_q99, false, {}},
        {"energy bias", "ΣI / ΣR − 1, signed", &image_error::energy_bias, false, {}},
    };
    return all;
}

const std::vector<double>& targets_of(const study& all, const metric& what) {
    return what.value == &aglow::image_error::relmse ? all.relmse_targets : what.targets;
}

std::vector<std::string> methods_of(const study& all) {
    std::vector<std::string> names;
    for (const run_note& run : all.runs) {
        if (std::find(names.begin(), names.end(), run.method) == names.end()) { names.push_back(run.method); }
    }
    std::stable_partition(names.begin(), names.end(), [&](const std::string& name) { return name == all.baseline; });
    return names;
}

}  // namespace error_vs_time
