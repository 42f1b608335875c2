// Clean twins of a static set: the declared model with noise at the same set points, to see how often this procedure
// finds what is not there.
#include <algorithm>
#include <cmath>
#include <map>

#include "surrogates/discovery/static/static_loop.h"

namespace underbody::discovery {

dynamics::Measurements StaticLoop::twin(std::uint64_t seed) const {
    dynamics::Measurements data = data_;
    data.folder.clear();  // the folder beside belongs to the real data
    const std::vector<double> noise = experiment_.drawn_noise(seed);
    const std::vector<std::string>& quantities = experiment_.quantities();
    std::map<std::pair<std::size_t, std::string>, std::vector<double>> columns;
    for (std::size_t i = 0; i < experiment_.observations().size(); ++i) {
        const Observation& one = experiment_.observations()[i];
        std::vector<double>& values = columns[{one.run, quantities[one.quantity]}];
        values.resize(data.runs[one.run].table.rows(), std::nan(""));
        values[one.row] = experiment_.predict(one, {}) + noise[i];
    }
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        core::Table table;
        table.source = data_.runs[r].table.source;
        for (const core::Column& column : data_.runs[r].table.columns()) {
            const auto drawn = columns.find({r, column.name});
            if (column.is_text()) {
                table.add_text(column.name, column.text);
            } else if (drawn != columns.end()) {
                table.add_numbers(column.name, column.unit, drawn->second);
            } else if (std::find(quantities.begin(), quantities.end(), column.name) == quantities.end()) {
                table.add_numbers(column.name, column.unit, column.numbers);
            }
        }
        data.runs[r].table = std::move(table);
    }
    return data;
}

void StaticLoop::run_placebo() {
    DiscoverOptions quiet = options_;
    quiet.consequence = quiet.figures = false;
    quiet.placebo_twins = 0;
    double before = 0;
    double after = 0;
    for (std::size_t k = 0; k < options_.placebo_twins; ++k) {
        const Discovery of_twin =
            discover_static(model_, twin(options_.seed * 1000 + k), quiet, core::Progress::none());
        progress_.check();
        ++result_.placebo.twins;
        result_.placebo.alarms += of_twin.verdict == "none" ? 0 : 1;
        before += std::pow(of_twin.error.front().before.rmse, 2);
        after += std::pow(of_twin.error.front().after.rmse, 2);
    }
    result_.placebo.error_ratio = before > 0 ? std::sqrt(after / before) : 1;
}

}  // namespace underbody::discovery
