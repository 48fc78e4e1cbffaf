// A study as data for other programs: tidy CSV, and JSON that can be read back.
#pragma once

#include <string>
#include <string_view>

#include "error_vs_time/study.hpp"

namespace error_vs_time {

/// One line a run, one column a quantity; phases and counts get columns of their own.
[[nodiscard]] std::string runs_csv(const study& all);

/// Everything but the pictures, with the version of the schema.
[[nodiscard]] std::string report_json(const study& all);

/// What `report_json` wrote. Throws `std::runtime_error` for text that is no such report, or of another version.
[[nodiscard]] study read_report(std::string_view json_text);

}  // namespace error_vs_time
