#include "surrogates/dynamics/simulate/declared_noise.h"

#include <cmath>
#include <string>
#include <vector>

#include "core/quantile.h"
#include "surrogates/dynamics/simulate/clean_readings.h"
#include "surrogates/dynamics/simulate/sensor_noise.h"

namespace underbody::dynamics {

double scatter_of(const Model& model, const Measurements& data, const std::string& channel) {
    std::vector<double> each;
    for (const MeasuredRun& run : data.runs) {
        const core::Column* column = run.table.find(channel);
        if (column == nullptr || column->is_text()) {
            continue;
        }
        const std::vector<double>& time = run.table.numbers("time");
        std::vector<double> values = column->numbers;
        if (channel == channel_name(Channel::gap)) {
            drop_saturated(time, values);  // a reading at the end of the range has none
        }
        if (const double own = sensor_noise(time, values); std::isfinite(own)) {
            each.push_back(
                own * (channel == channel_name(Channel::heave_velocity) ? std::abs(model.records.velocity_factor) : 1));
        }
    }
    return each.empty() ? 0 : core::median(each);
}

std::optional<Measurements> without_doubtful_noise(const Model& model, const Measurements& data,
                                                   core::Problems& remarks) {
    std::optional<Measurements> without;
    for (const auto& [channel, declared] : data.noise) {
        const JudgedNoise judged = judged_noise(channel, declared, scatter_of(model, data, channel));
        if (judged.doubt.empty()) {
            continue;
        }
        remarks.push_back({core::Problem::Severity::warning, judged.doubt, {data.folder.string(), {}, {}, {}}});
        if (!without) {
            without = data;
        }
        without->noise.erase(channel);
    }
    return without;
}

}  // namespace underbody::dynamics
