#include "postproc/field/times.h"

#include <algorithm>

#include "core/text.h"
#include "core/units.h"
#include "postproc/field/field.h"

namespace underbody::postproc {

std::vector<double> stated_times(const Field& field) {
    std::vector<double> times;
    for (const auto& [key, text] : field.metadata) {
        if (key == "time_values") {
            for (const auto word : core::split(text, ' ')) {
                times.push_back(core::parse_in(std::string(word), "s"));
            }
        }
    }
    return times;
}

void state_times(Field& field, std::vector<double> times) {
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    if (times.empty()) {
        return;
    }
    field.metadata.emplace_back("times", std::to_string(times.size()) + " from " + core::format_number(times.front()) +
                                             " to " + core::format_number(times.back()));
    if (times.size() > 1) {
        std::string values;
        for (const double time : times) {
            values += (values.empty() ? "" : " ") + core::format_number(time);
        }
        field.metadata.emplace_back("time_values", values);
    }
}

}  // namespace underbody::postproc
