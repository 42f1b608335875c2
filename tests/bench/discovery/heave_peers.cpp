#include "tests/bench/discovery/heave_peers.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include "core/units.h"
#include "surrogates/discovery/heave/heave_error.h"
#include "surrogates/discovery/heave/heave_experiment.h"
#include "tests/bench/discovery/peer_fits.h"

namespace underbody::bench {

using discovery::HeaveExperiment;
using discovery::HeaveNoise;
using discovery::HeaveRecord;
using discovery::HeaveRecords;
using discovery::Hypothesis;

namespace {

constexpr std::size_t thinned = 25;  // steps of 0.04 s: neighbours nearer than a second tell one story
constexpr std::array<const char*, 4> variables{"gap", "heave_velocity", "time", "input_force"};

HeaveExperiment all_of(const dynamics::Model& model, const HeaveRecords& records) {
    std::vector<std::size_t> chosen(records.records.size());
    std::iota(chosen.begin(), chosen.end(), std::size_t{0});
    return {model, records, chosen, {}, {}};
}

double error_of(const HeaveExperiment& test, const std::vector<dynamics::EffectUse>& uses, const HeaveNoise& noise) {
    const discovery::BlockSquares sums = discovery::window_errors(test, uses, noise, 2).by_record(test.chosen().size());
    return std::sqrt(std::accumulate(sums.square.begin(), sums.square.end(), 0.0) /
                     std::accumulate(sums.count.begin(), sums.count.end(), 0.0));
}

/// A force as a correction table over the variables of these numbers, on a grid between `low` and `high`.
dynamics::EffectUse correction(const std::vector<std::size_t>& over, const std::vector<double>& low,
                               const std::vector<double>& high, const std::vector<std::size_t>& nodes,
                               const std::function<Eigen::VectorXd(const Eigen::MatrixXd&)>& force) {
    std::size_t count = 1;
    for (const std::size_t n : nodes) {
        count *= n;
    }
    Eigen::MatrixXd at(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(over.size()));
    for (std::size_t i = 0; i < count; ++i) {
        std::size_t rest = i;
        for (std::size_t v = 0; v < over.size(); ++v) {
            at(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(v)) =
                low[v] + (high[v] - low[v]) * static_cast<double>(rest % nodes[v]) / static_cast<double>(nodes[v] - 1);
            rest /= nodes[v];
        }
    }
    const Eigen::VectorXd values = force(at);
    core::Table table;
    table.source = "correction.csv";
    for (std::size_t v = 0; v < over.size(); ++v) {
        const Eigen::VectorXd column = at.col(static_cast<Eigen::Index>(v));
        table.add_numbers(variables[over[v]], core::find_quantity(variables[over[v]])->unit,
                          {column.begin(), column.end()});
    }
    table.add_numbers("lift_force", "N", {values.begin(), values.end()});
    dynamics::EffectUse use = dynamics::neutral_use("unknown");
    use.quantity = "lift_force";
    use.table = tables::ForceTable::fit(table, "lift_force");
    use.table_file = table.source;
    return use;
}

}  // namespace

struct HeavePeers::Data {
    const dynamics::Model& model;
    HeaveRecords records, test_records;
    HeaveExperiment train, test;
    HeaveNoise noise;
    Eigen::MatrixXd at;        ///< the four variables
    Eigen::VectorXd residual;  ///< N, thinned
    Eigen::VectorXd sigma;     ///< N, what sensor noise leaves of it
    std::vector<double> low, high;

    Data(const dynamics::Model& m, const Sample& sample)
        : model(m),
          records(discovery::prepare_heave_records(m, sample.train)),
          test_records(discovery::prepare_heave_records(m, sample.test)),
          train(all_of(m, records)),
          test(all_of(m, test_records)) {
        noise.gap = heave_noise;
        std::vector<std::array<double, 6>> rows;
        std::vector<double> input;
        for (const HeaveRecord& record : records.records) {
            const discovery::HeaveExplanation declared = train.explanation(index(record), {});
            const discovery::SmoothedRun run = smoothed(record, declared);
            discovery::transform_input(record, declared, input);
            for (std::size_t k = thinned; k < run.time.size(); k += thinned) {
                rows.push_back({run.gap[k], run.velocity[k], run.time[k], input[k], run.force[k], run.force_sigma[k]});
            }
        }
        const auto n = static_cast<Eigen::Index>(rows.size());
        at.resize(n, 4);
        residual.resize(n);
        sigma.resize(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const std::array<double, 6>& row = rows[static_cast<std::size_t>(i)];
            for (Eigen::Index v = 0; v < 4; ++v) {
                at(i, v) = row[static_cast<std::size_t>(v)];
            }
            residual(i) = row[4];
            sigma(i) = row[5];
        }
        for (Eigen::Index v = 0; v < 4; ++v) {
            low.push_back(at.col(v).minCoeff());
            high.push_back(at.col(v).maxCoeff());
        }
    }

    [[nodiscard]] std::size_t index(const HeaveRecord& record) const {
        return static_cast<std::size_t>(&record - records.records.data());
    }
    [[nodiscard]] discovery::SmoothedRun smoothed(const HeaveRecord& record,
                                                  const discovery::HeaveExplanation& explanation) const {
        return discovery::smooth_with_force(record, explanation, noise, 0.001 * record.plant->terms.mass);
    }
    [[nodiscard]] Eigen::VectorXd in_noise() const { return residual.cwiseQuotient(sigma); }
    /// Each variable to mean zero and variance one over the training data.
    [[nodiscard]] Eigen::MatrixXd scaled(const Eigen::MatrixXd& x) const {
        Eigen::MatrixXd out(x.rows(), x.cols());
        for (Eigen::Index v = 0; v < x.cols(); ++v) {
            const double mean = at.col(v).mean();
            out.col(v) = (x.col(v).array() - mean) / std::sqrt((at.col(v).array() - mean).square().mean() + 1e-300);
        }
        return out;
    }
    /// What these uses take from the residual force at the thinned times, in noise.
    [[nodiscard]] Eigen::VectorXd taken_by(const std::vector<dynamics::EffectUse>& uses, double late) const {
        Eigen::VectorXd column(residual.size());
        Eigen::Index i = 0;
        for (const HeaveRecord& record : records.records) {
            HeaveRecord read = record;
            if (late != 0) {  // the smoother knows no late sensor: the reading is what it would be without it
                const discovery::SmoothedRun own = smoothed(record, train.explanation(index(record), {}));
                for (std::size_t k = 0; k < read.gap.size(); ++k) {
                    read.gap[k] += late * own.velocity[k];
                }
            }
            const discovery::SmoothedRun run = smoothed(read, train.explanation(index(record), uses));
            for (std::size_t k = thinned; k < run.time.size(); k += thinned, ++i) {
                column(i) = (residual(i) - run.force[k]) / sigma(i);
            }
        }
        return column;
    }
    /// Frequency of the line that explains most of the residual, Hz.
    [[nodiscard]] double strongest_line() const {
        double best = -1, place = 0.3;
        const Eigen::VectorXd y = in_noise();
        for (double f = 0.03; f < 4; f *= 1.02) {
            Eigen::MatrixXd wave(y.size(), 2);
            wave.col(0) = (6.283185307179586 * f * at.col(2).array()).sin();
            wave.col(1) = (6.283185307179586 * f * at.col(2).array()).cos();
            const double gain =
                (wave.transpose() * y).dot((wave.transpose() * wave).ldlt().solve(wave.transpose() * y));
            if (gain > best) {
                best = gain;
                place = f;
            }
        }
        return place;
    }
};

HeavePeers::HeavePeers(const dynamics::Model& model, const Sample& sample)
    : data_(std::make_unique<Data>(model, sample)) {}
HeavePeers::~HeavePeers() = default;

PeerAnswer HeavePeers::sparse_regression() const {
    const Data& d = *data_;
    struct Term {
        const Hypothesis* hypothesis;
        std::vector<double> start;
        std::size_t parameter;
        double per_unit;  ///< the number over the coefficient of the unit column
    };
    std::vector<Hypothesis> list = discovery::heave_hypotheses(d.model, {});
    std::erase_if(list, [](const Hypothesis& h) { return h.uses.size() > 1; });
    std::vector<Term> terms;
    Eigen::MatrixXd library(d.residual.size(), 0);
    const auto add = [&](const Hypothesis& h, const std::vector<double>& start, std::size_t j, double step) {
        std::vector<double> moved = start;
        moved[j] += step;
        const bool late = h.names.front() == "gap_sensor_delay";
        const Eigen::VectorXd column =
            d.taken_by(late ? std::vector<dynamics::EffectUse>{} : h.with(moved), late ? step : 0) / step;
        if (!column.allFinite() || column.norm() < 1e-9) {
            return;
        }
        library.conservativeResize(Eigen::NoChange, library.cols() + 1);
        library.rightCols(1) = column / column.norm();
        terms.push_back({&h, start, j, 1 / column.norm()});
    };
    for (const Hypothesis& h : list) {
        const std::vector<double> start = h.start();
        if (h.names.front() == "periodic_disturbance") {
            const double f = d.strongest_line();
            add(h, {0, f, 0}, 0, 1e-4);
            add(h, {0, f, 1.5707963267948966}, 0, 1e-4);
            continue;
        }
        const dynamics::EffectInfo& info = dynamics::effect(h.names.front()).info();
        for (std::size_t j = 0; j < start.size(); ++j) {
            if (!info.parameters[h.slots[j].value].shape) {
                add(h, start, j, 0.05 * h.parameters[j].typical);
            }
        }
    }
    const Eigen::VectorXd chosen = thresholded_least_squares(library, d.in_noise());
    PeerAnswer answer;
    std::set<std::string> names;
    std::vector<dynamics::EffectUse> uses;
    for (std::size_t k = 0; k < terms.size(); ++k) {
        const Term& term = terms[k];
        const double coefficient = chosen(static_cast<Eigen::Index>(k)) * term.per_unit;
        if (coefficient == 0) {
            continue;
        }
        names.insert(term.hypothesis->names.front());
        std::vector<double> numbers = term.start;
        const discovery::FitParameter& p = term.hypothesis->parameters[term.parameter];
        const bool turned = p.lower >= 0 && coefficient < 0 && term.hypothesis->names.front() == "periodic_disturbance";
        numbers[term.parameter] =
            turned ? -coefficient : std::clamp(numbers[term.parameter] + coefficient, p.lower, p.upper);
        if (turned) {
            numbers[2] += 3.141592653589793;
        }
        for (dynamics::EffectUse& use : term.hypothesis->with(numbers)) {
            uses.push_back(std::move(use));
        }
    }
    answer.names.assign(names.begin(), names.end());
    answer.verdict = names.empty() ? "none" : "effect";
    answer.rmse["gap"] = error_of(d.test, uses, d.noise);
    return answer;
}

PeerAnswer HeavePeers::polynomial() const {
    const Data& d = *data_;
    const Polynomial fit = fit_polynomial(d.scaled(d.at), d.in_noise());
    PeerAnswer answer;
    answer.verdict = fit.degree >= 0 ? "unknown" : "none";
    std::vector<dynamics::EffectUse> uses;
    if (fit.degree >= 0) {
        const double sigma = d.sigma.mean();
        uses.push_back(correction({0, 1, 2, 3}, d.low, d.high, {9, 9, 9, 9}, [&](const Eigen::MatrixXd& x) {
            return Eigen::VectorXd(sigma * fit.at(d.scaled(x)));
        }));
    }
    answer.rmse["gap"] = error_of(d.test, uses, d.noise);
    return answer;
}

PeerAnswer HeavePeers::gaussian_process() const {
    const Data& d = *data_;
    const GaussianProcess fit = fit_gaussian_process(d.scaled(d.at), d.in_noise());
    PeerAnswer answer;
    answer.verdict = fit.found ? "unknown" : "none";
    std::vector<dynamics::EffectUse> uses;
    if (fit.found) {
        const double sigma = d.sigma.mean();
        std::vector<std::size_t> nodes;
        for (std::size_t v = 0; v < 4; ++v) {
            if (fit.depends_on(v)) {
                answer.depends_on.emplace_back(variables[v]);
            }
            nodes.push_back(fit.depends_on(v) ? 13 : 5);
        }
        uses.push_back(correction({0, 1, 2, 3}, d.low, d.high, nodes, [&](const Eigen::MatrixXd& x) {
            return Eigen::VectorXd(sigma * fit.at(d.scaled(x)));
        }));
    }
    answer.rmse["gap"] = error_of(d.test, uses, d.noise);
    return answer;
}

double heave_best(const dynamics::Model& model, const Case& wanted, const Sample& sample) {
    const HeaveRecords records = discovery::prepare_heave_records(model, sample.train);
    const HeaveRecords test_records = discovery::prepare_heave_records(model, sample.test);
    const HeaveExperiment train = all_of(model, records), test = all_of(model, test_records);
    HeaveNoise noise;
    noise.gap = heave_noise * (wanted.coloured ? 0.7 : 1);
    noise.slow = wanted.coloured ? 0.7 * heave_noise : 0;
    noise.slow_time = 0.3;
    std::vector<dynamics::EffectUse> uses;
    if (sample.missing) {
        const std::vector<double> low{0.005, -0.15, 0, -0.2}, high{0.6, 0.15, 40, 0.25};
        std::vector<std::size_t> over, nodes;
        std::vector<double> from, to;
        for (std::size_t v = 0; v < 4; ++v) {
            if (std::find(sample.depends_on.begin(), sample.depends_on.end(), variables[v]) !=
                sample.depends_on.end()) {
                over.push_back(v);
                from.push_back(low[v]);
                to.push_back(high[v]);
            }
        }
        nodes.assign(over.size(), over.size() == 1 ? 401 : 101);
        uses.push_back(correction(over, from, to, nodes, [&](const Eigen::MatrixXd& x) {
            Eigen::VectorXd force(x.rows());
            for (Eigen::Index i = 0; i < x.rows(); ++i) {
                double point[4] = {0.1, 0, 0, 0};
                for (std::size_t v = 0; v < over.size(); ++v) {
                    point[over[v]] = x(i, static_cast<Eigen::Index>(v));
                }
                force(i) = sample.missing(point[2], point[0], point[1], point[3]);
            }
            return force;
        }));
        train.fit_process(uses, noise);
        return error_of(test, uses, noise);
    }
    train.fit_process({}, noise);
    if (wanted.names.empty()) {
        return error_of(test, {}, noise);
    }
    // the variant of each name that explains most; of several names together
    double best = 1e300;
    HeaveExperiment::Result chosen;
    std::vector<Hypothesis> list = discovery::heave_hypotheses(model, {});
    std::erase_if(list, [&](const Hypothesis& h) {
        return std::find(wanted.names.begin(), wanted.names.end(), h.names.front()) == wanted.names.end();
    });
    for (Hypothesis& h : list) {
        if (h.names.front() == "periodic_disturbance") {
            h.starts = train.periodic_starts({}, noise, 2);
        }
        const HeaveExperiment::Result fit = train.fit(h, noise);
        if (wanted.names.size() == 1 && fit.fitted.cost < best) {
            best = fit.fitted.cost;
            chosen = fit;
        }
    }
    if (wanted.names.size() == 2) {
        const auto of = [&](const std::string& name) {
            return *std::find_if(list.begin(), list.end(),
                                 [&](const Hypothesis& h) { return h.names.front() == name; });
        };
        const Hypothesis a = of(wanted.names[0]), b = of(wanted.names[1]);
        chosen = train.fit(discovery::joined(a, a.starts.front(), b, b.starts.front()), noise);
    }
    return error_of(test, chosen.fitted.hypothesis.with(chosen.fitted.fit.parameters), chosen.noise);
}

}  // namespace underbody::bench
