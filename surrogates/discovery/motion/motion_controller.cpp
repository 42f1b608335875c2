#include "surrogates/discovery/motion/motion_controller.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

namespace {

constexpr std::size_t own_rows = 2, reading_rows = 3;
constexpr double loud = 6;       ///< the same of an input's change, before anything is fitted
constexpr int most_rounds = 30;  ///< until the same rows are left out
constexpr double far_off = 4;    ///< robust standard deviations: a step of the set point, no answer to a reading

/// Of the change from row to row: what is commanded besides and slowly (a wave, a set point that moves) hardly shows,
/// while the answer to the sensors' noise does.
double bend(const std::vector<double>& values, std::size_t k) { return values[k] - 2 * values[k - 1] + values[k - 2]; }

/// Changes of the change of one input (y), and what they may follow (a row of x each).
struct Changes {
    std::vector<std::vector<double>> x;
    std::vector<double> y;
};

Changes changes_of(const MotionRig& rig, const InputAnswer& answer) {
    Changes changes;
    for (const MotionRecord& record : rig.records) {
        const core::Column* column = rig.data.runs[record.run].table.find(answer.input);
        if (column == nullptr || column->is_text()) {
            continue;
        }
        const std::vector<double>& u = column->numbers;
        for (std::size_t k = record.first + own_rows + reading_rows + 2; k <= record.last; ++k) {
            std::vector<double> x;
            for (std::size_t i = 0; i < own_rows; ++i) {
                x.push_back(bend(u, k - 1 - i));
            }
            for (const std::size_t c : rig.channels) {
                const std::vector<double>& y = record.readings.value[c];
                for (std::size_t i = answer.first; i < answer.first + reading_rows; ++i) {
                    x.push_back(y.empty() ? 0 : bend(y, k - i));
                }
            }
            const double change = bend(u, k);
            if (std::isfinite(change) && std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); })) {
                changes.x.push_back(std::move(x));
                changes.y.push_back(change);
            }
        }
    }
    return changes;
}

/// Coefficients of the first `columns` of x (in units of their root mean squares), and the sum of squares that they
/// leave of the rows that are used.
Eigen::VectorXd solve(const Changes& changes, const std::vector<bool>& used, Eigen::Index columns, double& left) {
    const auto rows = static_cast<Eigen::Index>(std::count(used.begin(), used.end(), true));
    Eigen::MatrixXd a(rows, columns);
    Eigen::VectorXd b(rows);
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (used[i]) {
            a.row(row) = Eigen::Map<const Eigen::VectorXd>(changes.x[i].data(), columns).transpose();
            b(row++) = changes.y[i];
        }
    }
    Eigen::VectorXd size = a.colwise().norm().transpose();
    size = size.unaryExpr([](double v) { return v > 0 ? v : 1.0; });
    a = a * size.cwiseInverse().asDiagonal();
    const Eigen::VectorXd scaled = a.completeOrthogonalDecomposition().solve(b);
    left = (b - a * scaled).squaredNorm();
    return scaled.cwiseQuotient(size);
}

InputAnswer read_controller(const MotionRig& rig, const std::string& input) {
    constexpr std::size_t least_rows = 100;
    // of what the input's own past leaves of its changes, the share that readings must explain, and that chance does
    constexpr double answers = 0.5, chance = 0.1;
    InputAnswer answer;
    answer.input = input;
    answer.first = rig.model.records.input_between == dynamics::RecordReading::Between::linear ? 1 : 0;
    const Changes changes = changes_of(rig, answer);
    static_assert(own_rows == 2);
    if (changes.y.size() < least_rows) {
        answer.found = InputAnswer::Found::unread;
        return answer;
    }
    const auto columns = static_cast<Eigen::Index>(changes.x.front().size());
    // A step of the set point goes on standing among the input's own changes before the next rows, where it would have
    // a pull of its own.
    const double usual = robust_deviation(changes.y);
    std::vector<bool> quiet;
    for (std::size_t i = 0; i < changes.y.size(); ++i) {
        const std::vector<double>& x = changes.x[i];
        quiet.push_back(std::max({std::abs(changes.y[i]), std::abs(x[0]), std::abs(x[1])}) <= loud * usual + 1e-12);
    }
    std::vector<bool> used = quiet;
    Eigen::VectorXd best;
    double left = 0, left_alone = 0;
    for (int round = 0; round < most_rounds; ++round) {
        best = solve(changes, used, columns, left);
        solve(changes, used, own_rows, left_alone);
        std::vector<double> error;
        for (std::size_t i = 0; i < changes.y.size(); ++i) {
            error.push_back(changes.y[i] - best.dot(Eigen::Map<const Eigen::VectorXd>(changes.x[i].data(), columns)));
        }
        const double sigma = robust_deviation(error);
        const std::vector<bool> before = used;
        for (std::size_t i = 0; i < error.size(); ++i) {
            used[i] = quiet[i] && std::abs(error[i]) <= far_off * sigma + 1e-12;
        }
        if (used == before) {
            break;
        }
    }
    const double explained = left_alone > 0 ? 1 - left / left_alone : 0;
    answer.found = explained > answers  ? InputAnswer::Found::answers
                   : explained > chance ? InputAnswer::Found::unread
                                        : InputAnswer::Found::none;
    if (answer.found == InputAnswer::Found::answers) {
        answer.own = {best(0), best(1)};
        for (std::size_t c = 0; c < rig.channels.size(); ++c) {
            const auto at = static_cast<Eigen::Index>(own_rows + reading_rows * c);
            answer.reading.push_back({best(at), best(at + 1), best(at + 2)});
        }
    }
    return answer;
}

/// The numbers of a run's table by column, to be changed row by row.
struct Columns {
    explicit Columns(const dynamics::MeasuredRun& of) : run(of) {
        for (const core::Column& column : of.table.columns()) {
            if (!column.is_text()) {
                names.push_back(column.name);
                units.push_back(column.unit);
                values.push_back(column.numbers);
            }
        }
    }
    /// Of the rows from..to - 1.
    [[nodiscard]] dynamics::MeasuredRun made(std::size_t from, std::size_t to) const {
        dynamics::MeasuredRun out = run;
        out.table = {};
        out.table.source = run.table.source;
        for (std::size_t i = 0; i < names.size(); ++i) {
            out.table.add_numbers(names[i], units[i],
                                  {values[i].begin() + static_cast<std::ptrdiff_t>(from),
                                   values[i].begin() + static_cast<std::ptrdiff_t>(to)});
        }
        return out;
    }
    std::vector<double>* find(const std::string& name) {
        const auto place = std::find(names.begin(), names.end(), name);
        return place != names.end() ? &values[static_cast<std::size_t>(place - names.begin())] : nullptr;
    }
    const dynamics::MeasuredRun& run;
    std::vector<std::string> names, units;
    std::vector<std::vector<double>> values;
};

}  // namespace

std::vector<InputAnswer> read_controllers(const MotionRig& rig) {
    std::vector<InputAnswer> list;
    for (const std::string& input : rig.inputs) {
        list.push_back(read_controller(rig, input));
    }
    return list;
}

dynamics::MeasuredRun run_again(const MotionRig& rig, const dynamics::Model& model, const MotionRecord& record,
                                const MotionTrial& trial, const std::vector<InputAnswer>& answers,
                                core::Random& random) {
    constexpr double past = 2;  // s of readings that tell where the run began
    // s of inputs that may act on a step (delays and lags of actuators, clocks that are off): with all of a run the
    // work would grow with its square
    constexpr double inputs_before = 10, inputs_after = 3;
    const dynamics::MeasuredRun& logged = rig.data.runs[record.run];
    auto motion = rig.motion.run(model, logged, model.records);
    motion->set_noise(rig.noise.white);
    const std::vector<double> time = motion->time();
    std::size_t until = record.first;
    while (until < record.last && time[until] < time[record.first] + past) {
        ++until;
    }
    const auto begin = dynamics::fitted_state(*motion, record.readings, record.first, until);
    if (!begin) {
        throw core::InputError("range", "the begin of run " + record.name + " was not read", {}, {});
    }
    Columns columns(logged);
    std::vector<std::vector<double>> answered(answers.size(), std::vector<double>(time.size(), 0.0));
    std::vector<std::vector<double>> apart(rig.channels.size(), std::vector<double>(time.size(), 0.0));
    for (std::size_t k = 0; k < time.size(); ++k) {
        if (std::vector<double>* input = columns.find(trial.input)) {
            (*input)[k] += trial.added[k] / rig.model.records.factor_of(trial.input);
        }
    }
    const std::vector<std::vector<double>> with_wave = columns.values;
    const bool closed = std::any_of(answers.begin(), answers.end(),
                                    [](const InputAnswer& a) { return a.found == InputAnswer::Found::answers; });
    std::array<double, dynamics::most_states> slow{};
    for (const std::size_t c : rig.channels) {
        slow[c] = rig.noise.slow[c] * random.normal();
    }
    dynamics::MotionState y = *begin;
    dynamics::ContactState bearing = dynamics::ContactState::free;
    std::size_t from = 0;  // the row that `motion` begins with
    const auto follow_inputs = [&](std::size_t k) {
        const auto row = [&](double t) {
            return static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), t) - time.begin());
        };
        from = closed ? row(time[k] - inputs_before) : 0;
        const std::size_t to = closed ? std::max(row(time[k] + inputs_after), k + 2) : time.size();
        motion = rig.motion.run(model, columns.made(from, std::min(to, time.size())), model.records);
    };
    follow_inputs(record.first);
    for (std::size_t k = record.first; k <= record.last; ++k) {
        for (std::size_t c = 0; c < rig.channels.size(); ++c) {
            const std::size_t state = rig.channels[c];
            const double reading =
                motion->reading(k - from, state, y) + slow[state] + rig.noise.white[state] * random.normal();
            const std::vector<double>& was = record.readings.value[state];
            if (!was.empty() && std::isfinite(was[k])) {
                apart[c][k] = reading - was[k];
                const std::string& name = motion->shape().states[state].channel;
                (*columns.find(name))[k] = reading / rig.model.records.factor_of(name);
            }
        }
        if (k == record.last) {
            break;
        }
        for (std::size_t a = 0; a < answers.size(); ++a) {
            const InputAnswer& answer = answers[a];
            if (answer.found != InputAnswer::Found::answers) {
                continue;
            }
            for (std::size_t i = 0; i < answer.own.size() && i + 1 <= k; ++i) {
                answered[a][k] += answer.own[i] * answered[a][k - 1 - i];
            }
            for (std::size_t c = 0; c < answer.reading.size(); ++c) {
                for (std::size_t i = 0; i < answer.reading[c].size() && i + answer.first <= k; ++i) {
                    answered[a][k] += answer.reading[c][i] * apart[c][k - answer.first - i];
                }
            }
            std::vector<double>& input = *columns.find(answer.input);
            const std::size_t place = static_cast<std::size_t>(&input - columns.values.data());
            for (std::size_t later = k; later < std::min(k + 2, time.size()); ++later) {
                input[later] = with_wave[place][later] + answered[a][k];
            }
        }
        if (closed) {
            follow_inputs(k);
        }
        const double dt = time[k + 1] - time[k], decay = std::exp(-dt / rig.noise.slow_time);
        dynamics::MotionLoads loads{};
        for (std::size_t l = 0; l < motion->shape().loads.size(); ++l) {
            loads[l] = rig.noise.load[l] / std::sqrt(dt) * random.normal();
        }
        motion->advance(k - from, y, bearing, loads);
        for (const std::size_t c : rig.channels) {
            slow[c] = decay * slow[c] + std::sqrt(1 - decay * decay) * rig.noise.slow[c] * random.normal();
        }
    }
    return columns.made(0, record.last + 1);
}

}  // namespace underbody::discovery
