#include "surrogates/discovery/static/static_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "core/angle.h"
#include "core/counted.h"
#include "core/text.h"
#include "core/units.h"
#include "core/water.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/discovery/wording.h"

namespace underbody::discovery {

using dynamics::Channel;

namespace {

/// Readings of one quantity and what the model says.
struct Readings {
    std::vector<const Observation*> observation;
    std::vector<double> measured;
    std::vector<double> predicted;
};

Readings readings_of(const StaticExperiment& experiment, std::size_t quantity) {
    Readings readings;
    for (const Observation& one : experiment.observations()) {
        if (one.quantity == quantity) {
            readings.observation.push_back(&one);
            readings.measured.push_back(one.value);
            readings.predicted.push_back(experiment.predict(one, {}));
        }
    }
    return readings;
}

struct Outside {
    std::string ranges;  ///< "gap 2 to 50 measured, 0.001 to 0.1 in lift.csv"
    std::string slip;    ///< a unit that would explain it; empty: none
};

Outside outside_of(const StaticExperiment& experiment) {
    Outside outside;
    for (const dynamics::ForceSource& source : experiment.model().forces) {
        for (std::size_t i = 0; i < source.axes.size(); ++i) {
            const tables::TableAxis& axis = source.table.axes()[i];
            double low = 1e300, high = -1e300;
            for (const Observation& one : experiment.observations()) {
                low = std::min(low, one.at[source.axes[i]]);
                high = std::max(high, one.at[source.axes[i]]);
            }
            const std::string text = axis.name + " " + core::format_number(low, 3) + " to " +
                                     core::format_number(high, 3) + " measured, " + core::format_number(axis.lower, 3) +
                                     " to " + core::format_number(axis.upper, 3) + " in " + source.table_file;
            if ((low >= axis.lower && high <= axis.upper) || outside.ranges.find(text) != std::string::npos) {
                continue;
            }
            outside.ranges += (outside.ranges.empty() ? "" : "; ") + text;
            for (const double factor : {1000.0, 0.001, 1 / core::degree, core::degree}) {
                if (low > axis.upper && low * 0.999 / factor >= axis.lower && high / factor <= 1.001 * axis.upper) {
                    outside.slip = "The " + axis.name + " looks " + core::format_number(factor, 4) +
                                   " times too large: is its unit right?";
                } else if (high < axis.lower && low / factor >= 0.999 * axis.lower && high / factor <= axis.upper) {
                    outside.slip = "The " + axis.name + " looks " + core::format_number(1 / factor, 4) +
                                   " times too small: is its unit right?";
                }
            }
        }
    }
    return outside;
}

class Checker {
public:
    Checker(const StaticExperiment& experiment, const dynamics::Measurements& data)
        : experiment_(experiment), place_{data.folder.string(), {}, {}, {}} {
        for (std::size_t q = 0; q < experiment.quantities().size(); ++q) {
            readings_.push_back(readings_of(experiment, q));
        }
    }

    core::Problems run() {
        for (std::size_t q = 0; q < readings_.size(); ++q) {
            check_standing(q);
            check_unit(q);
        }
        check_swapped();
        check_tables();
        check_twice();
        check_channels();
        return std::move(problems_);
    }

private:
    void warn(const std::string& text) { problems_.push_back({core::Problem::Severity::warning, text, place_}); }
    void note(const std::string& text) { problems_.push_back({core::Problem::Severity::note, text, place_}); }

    [[nodiscard]] std::string value_of(std::size_t q, double value) const {
        return core::format_number(value, 4) + " " + core::find_quantity(experiment_.quantities()[q])->unit;
    }

    /// The same value again and again, or many readings at the very end of the range.
    void check_standing(std::size_t q) {
        std::map<double, std::size_t> count;
        for (const double value : readings_[q].measured) {
            ++count[value];
        }
        const std::size_t n = readings_[q].measured.size();
        const auto most = std::max_element(count.begin(), count.end(),
                                           [](const auto& a, const auto& b) { return a.second < b.second; });
        const std::string& name = experiment_.quantities()[q];
        if (most->second * 2 > n) {
            warn(name + " reads " + value_of(q, most->first) + " in " + std::to_string(most->second) + " of " +
                 std::to_string(n) + " readings: the sensor stands still; nothing can be learnt from these readings");
            return;
        }
        const auto clipped = [&](double value, std::size_t times, const char* end) {
            if (times >= 4 && times * 50 > n) {
                warn(std::to_string(times) + " readings of " + name + " are exactly its " + end + ", " +
                     value_of(q, value) +
                     ": the sensor is clipped there; what looks missing may be its range. Leave these readings out");
            }
        };
        clipped(count.begin()->first, count.begin()->second, "least");
        clipped(count.rbegin()->first, count.rbegin()->second, "largest");
    }

    /// Forces a thousand times too large and the like.
    void check_unit(std::size_t q) {
        double cross = 0, of_model = 0, of_data = 0;
        for (std::size_t i = 0; i < readings_[q].measured.size(); ++i) {
            cross += readings_[q].measured[i] * readings_[q].predicted[i];
            of_model += readings_[q].predicted[i] * readings_[q].predicted[i];
            of_data += readings_[q].measured[i] * readings_[q].measured[i];
        }
        const double along = cross / std::sqrt(std::max(of_model * of_data, 1e-300));
        const double ratio = cross / std::max(of_model, 1e-300);
        struct Slip {
            double factor;
            const char* what;
        };
        static constexpr std::array<Slip, 7> slips{
            {{1000, "the column holds thousandths (mN) and is labelled as whole units"},
             {0.001, "the column holds whole units and is labelled as thousandths"},
             {101.97162, "the column holds gram-force and is labelled as newton"},
             {0.10197162, "the column holds kilogram-force and is labelled as newton"},
             {core::standard_gravity, "the column holds newton and is labelled as kilogram-force"},
             {1e-3 * core::standard_gravity, "the column is labelled as gram-force and was converted already"},
             {-1, "its sign is that of the other axis (lift is positive up, drag positive when it slows the body)"}}};
        for (const Slip& slip : slips) {
            if (std::abs(along) > 0.9 && std::abs(ratio / slip.factor - 1) < 0.15) {
                warn(experiment_.quantities()[q] + " is " + core::format_number(ratio, 3) +
                     " times what the model says throughout: likely " + slip.what +
                     ". Set the unit in the header right; the verdict below takes the numbers as they stand");
            }
        }
    }

    void check_swapped() {
        const auto misfit = [&](std::size_t measured, std::size_t predicted) {
            std::map<std::pair<std::size_t, std::size_t>, double> said;
            for (std::size_t i = 0; i < readings_[predicted].predicted.size(); ++i) {
                const Observation& one = *readings_[predicted].observation[i];
                said[{one.run, one.row}] = readings_[predicted].predicted[i];
            }
            double sum = 0;
            for (std::size_t i = 0; i < readings_[measured].measured.size(); ++i) {
                const Observation& one = *readings_[measured].observation[i];
                const auto other = said.find({one.run, one.row});
                sum += other == said.end() ? 0 : std::pow(readings_[measured].measured[i] - other->second, 2);
            }
            return sum;
        };
        for (std::size_t a = 0; a < readings_.size(); ++a) {
            for (std::size_t b = a + 1; b < readings_.size(); ++b) {
                if (misfit(a, b) + misfit(b, a) < 0.1 * (misfit(a, a) + misfit(b, b))) {
                    warn("the columns " + experiment_.quantities()[a] + " and " + experiment_.quantities()[b] +
                         " look swapped: each agrees with what the model says of the other");
                }
            }
        }
    }

    void check_tables() {
        if (experiment_.outside_tables() > 0) {
            const Outside outside = outside_of(experiment_);
            warn(core::counted_of(experiment_.outside_tables(), experiment_.observations().size(), "reading", "lies",
                                  "lie") +
                 " outside the range of a declared table, which holds its end value there (" + outside.ranges +
                 "): what is found there is about the table's end, not about physics" +
                 (outside.slip.empty() ? "" : ". " + outside.slip));
        }
    }

    /// A logger that wrote a block twice makes everything look more certain than it is.
    void check_twice() {
        std::map<std::vector<double>, std::size_t> seen;
        std::size_t twice = 0;
        for (const Observation& one : experiment_.observations()) {
            std::vector<double> key{static_cast<double>(one.quantity), one.value};
            for (const Channel channel : experiment_.varying()) {
                if (channel != Channel::time) {
                    key.push_back(one.at[channel]);
                }
            }
            twice += seen[key]++ > 0 ? 1 : 0;
        }
        if (twice * 4 > experiment_.observations().size()) {
            warn(std::to_string(twice) +
                 " readings stand there twice, to the last digit: everything looks more certain than it is");
        }
    }

    void check_channels() {
        const std::vector<Channel>& varying = experiment_.varying();
        if (experiment_.set_points() == 1) {
            warn(
                "all readings are at one set point: only that something is missing can be seen, not what; a bias, a "
                "gain, "
                "an offset of the gap and the like all fit it equally. Measure at other gaps and speeds");
        }
        std::string held;
        for (const Channel channel : {Channel::gap, Channel::speed, Channel::jet_voltage}) {
            if (model_feels(channel) && std::find(varying.begin(), varying.end(), channel) == varying.end()) {
                held += (held.empty() ? "" : "; ") + std::string(dynamics::channel_name(channel)) + " (" +
                        list_of(shown_by(channel)) + ")";
            }
        }
        if (!held.empty() && experiment_.set_points() > 1) {
            warn("held throughout, so that effects of it cannot be seen: " + held);
        }
        for (std::size_t a = 0; a < varying.size(); ++a) {
            for (std::size_t b = a + 1; b < varying.size(); ++b) {
                const double r = correlation(varying[a], varying[b]);
                if (std::abs(r) > 0.9) {
                    warn(std::string(dynamics::channel_name(varying[a])) + " ran together with " +
                         dynamics::channel_name(varying[b]) + " (correlation " + core::format_number(r, 2) +
                         "): an effect of one passes for an effect of the other. Measure in mixed order");
                }
            }
        }
    }

    /// Whether the declared forces change when a channel moves by a tenth.
    /// Effects that a static set shows only where the channel varies.
    [[nodiscard]] static std::vector<std::string> shown_by(Channel channel) {
        std::vector<std::string> names;
        for (const dynamics::Effect* effect : dynamics::effects()) {
            const dynamics::EffectInfo& info = effect->info();
            for (const auto* needs : {&info.search.needs, &info.search.needs_one_of}) {
                if (std::find(needs->begin(), needs->end(), dynamics::channel_name(channel)) != needs->end()) {
                    names.push_back(info.name);
                }
            }
        }
        return names;
    }

    [[nodiscard]] bool model_feels(Channel channel) const {
        Observation one = experiment_.observations().front();
        if (!one.at.has(channel)) {
            return false;
        }
        for (std::size_t q = 0; q < readings_.size(); ++q) {
            one.quantity = q;
            Observation moved = one;
            moved.at[channel] *= 1.1;
            if (std::abs(experiment_.predict(moved, {}) - experiment_.predict(one, {})) >
                1e-6 * std::abs(experiment_.predict(one, {}))) {
                return true;
            }
        }
        return false;
    }

    /// Of ranks (Spearman): a sweep is a sweep in any unit.
    [[nodiscard]] double correlation(Channel a, Channel b) const {
        const auto ranks = [&](Channel channel) {
            std::vector<double> values;
            for (const Observation& one : experiment_.observations()) {
                values.push_back(one.at[channel]);
            }
            std::vector<double> sorted = values;
            std::sort(sorted.begin(), sorted.end());
            for (double& value : values) {
                const auto range = std::equal_range(sorted.begin(), sorted.end(), value);
                value = 0.5 * static_cast<double>((range.first - sorted.begin()) + (range.second - sorted.begin()));
            }
            const double middle = mean(values);
            for (double& value : values) {
                value -= middle;
            }
            return values;
        };
        const std::vector<double> x = ranks(a), y = ranks(b);
        double xy = 0, xx = 0, yy = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            xy += x[i] * y[i];
            xx += x[i] * x[i];
            yy += y[i] * y[i];
        }
        return xy / std::sqrt(std::max(xx * yy, 1e-300));
    }

    const StaticExperiment& experiment_;
    core::Place place_;
    std::vector<Readings> readings_;
    core::Problems problems_;
};

}  // namespace

void refuse_outside_tables(const StaticExperiment& experiment, const dynamics::Measurements& data) {
    if (experiment.outside_tables() < experiment.observations().size()) {
        return;
    }
    const Outside outside = outside_of(experiment);
    throw core::InputError("range",
                           "every reading lies outside the range of the declared tables (" + outside.ranges +
                               "): there is nothing to compare",
                           core::Place{data.folder.string(), {}, {}, {}},
                           outside.slip.empty() ? "declare a table over the measured range" : outside.slip);
}

core::Problems check_static_data(const StaticExperiment& experiment, const dynamics::Measurements& data) {
    return Checker(experiment, data).run();
}

core::Problems check_runs_agree(const StaticExperiment& experiment, const dynamics::Measurements& data,
                                const std::vector<std::size_t>& chosen, const std::vector<double>& residuals) {
    struct Mean {
        double sum = 0;
        double count = 0;
    };
    // mean residual of a run less that of the other runs at the same set points
    std::map<std::tuple<std::size_t, std::size_t>, std::map<std::size_t, Mean>> by_point;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const Observation& one = experiment.observations()[chosen[i]];
        Mean& own = by_point[{one.quantity, one.set_point}][one.run];
        own.sum += residuals[i];
        own.count += 1;
    }
    core::Problems problems;
    for (std::size_t run = 0; run < data.runs.size(); ++run) {
        double square = 0;
        double degrees = 0;
        for (const auto& [point, runs] : by_point) {
            const auto own = runs.find(run);
            if (own == runs.end() || runs.size() < 2) {
                continue;
            }
            Mean others;
            for (const auto& [other, values] : runs) {
                others.sum += other == run ? 0 : values.sum;
                others.count += other == run ? 0 : values.count;
            }
            const double difference = own->second.sum / own->second.count - others.sum / others.count;
            square += difference * difference / (1 / own->second.count + 1 / others.count);
            degrees += 1;
        }
        if (degrees >= 3 && chi_squared_tail(square, degrees) < 1e-6) {
            problems.push_back({core::Problem::Severity::warning,
                                "the runs contradict each other: at the same " + core::format_number(degrees, 3) +
                                    " set points " + data.runs[run].name + " differs from the others by " +
                                    core::format_number(std::sqrt(square / degrees), 3) +
                                    " times the noise; look at these runs apart",
                                core::Place{data.folder.string(), {}, {}, {}}});
        }
    }
    return problems;
}

std::vector<std::size_t> accidents(const std::vector<double>& residuals) {
    const double sigma = std::max(robust_deviation(residuals), 1e-300);
    std::vector<std::size_t> list;
    for (std::size_t i = 0; i < residuals.size(); ++i) {
        if (std::abs(residuals[i]) > 6 * sigma) {
            list.push_back(i);
        }
    }
    return list.size() * 50 <= residuals.size() + 49 ? list : std::vector<std::size_t>{};
}

}  // namespace underbody::discovery
