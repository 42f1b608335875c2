#include "tests/bench/discovery/peers.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "surrogates/dynamics/simulate/predict.h"
#include "surrogates/dynamics/simulate/read_records.h"
#include "tests/bench/discovery/peer_fits.h"

namespace underbody::bench {

namespace {

using dynamics::Channel;

/// Set points and residuals of one quantity, in noise.
struct Data {
    std::vector<dynamics::Conditions> at;
    Eigen::VectorXd residual;
};

Data data_of(const dynamics::Model& model, const dynamics::Measurements& set, const std::string& quantity,
             double sigma) {
    const dynamics::StaticModel predicted(model, quantity);
    const dynamics::MeasuredRun& run = set.runs.front();
    const std::vector<double>& measured = run.table.numbers(quantity);
    Data data;
    data.residual.resize(static_cast<Eigen::Index>(measured.size()));
    for (std::size_t i = 0; i < measured.size(); ++i) {
        data.at.push_back(dynamics::set_point_of(run, i));
        data.residual(static_cast<Eigen::Index>(i)) = (measured[i] - predicted(data.at.back())) / sigma;
    }
    return data;
}

std::vector<Channel> varying(const Data& data) {
    std::vector<Channel> list;
    for (std::size_t c = 0; c < dynamics::channel_count; ++c) {
        std::set<double> values;
        for (const dynamics::Conditions& at : data.at) {
            if (std::isfinite(at.value[c])) {
                values.insert(at.value[c]);
            }
        }
        if (values.size() > 1) {
            list.push_back(static_cast<Channel>(c));
        }
    }
    return list;
}

std::vector<std::string> quantities_of(const dynamics::Measurements& set) {
    std::vector<std::string> list;
    for (const std::string& name : dynamics::force_channels()) {
        if (set.runs.front().table.find(name) != nullptr) {
            list.push_back(name);
        }
    }
    return list;
}

/// Every channel to mean zero and variance one over the training data.
struct Scaled {
    std::vector<Channel> channels;
    std::vector<double> shift, scale;
    Scaled(const Data& data, std::vector<Channel> wanted) : channels(std::move(wanted)) {
        for (const Channel c : channels) {
            double sum = 0, square = 0;
            for (const dynamics::Conditions& at : data.at) {
                sum += at[c];
                square += at[c] * at[c];
            }
            const double n = static_cast<double>(data.at.size());
            shift.push_back(sum / n);
            scale.push_back(std::sqrt(std::max(square / n - shift.back() * shift.back(), 1e-300)));
        }
    }
    [[nodiscard]] Eigen::MatrixXd operator()(const Data& data) const {
        Eigen::MatrixXd x(static_cast<Eigen::Index>(data.at.size()), static_cast<Eigen::Index>(channels.size()));
        for (Eigen::Index i = 0; i < x.rows(); ++i) {
            for (Eigen::Index k = 0; k < x.cols(); ++k) {
                const auto v = static_cast<std::size_t>(k);
                x(i, k) = (data.at[static_cast<std::size_t>(i)][channels[v]] - shift[v]) / scale[v];
            }
        }
        return x;
    }
};

double rmse(const Eigen::VectorXd& residual, double sigma) {
    return sigma * std::sqrt(residual.squaredNorm() / static_cast<double>(residual.size()));
}

}  // namespace

PeerAnswer sparse_regression(const dynamics::Model& model, const dynamics::Measurements& train,
                             const dynamics::Measurements& test, const Noise& sigma) {
    PeerAnswer answer;
    const std::vector<std::string> quantities = quantities_of(train);
    std::vector<Data> data, other;
    Eigen::Index rows = 0, test_rows = 0;
    for (const std::string& quantity : quantities) {
        data.push_back(data_of(model, train, quantity, sigma.at(quantity)));
        other.push_back(data_of(model, test, quantity, sigma.at(quantity)));
        rows += data.back().residual.size();
        test_rows += other.back().residual.size();
    }
    const std::vector<Channel> channels = varying(data.front());
    std::vector<std::string> names;
    Eigen::MatrixXd library(rows, 0), there(test_rows, 0);
    const auto fill = [&](const dynamics::Model& moved, double step, const std::vector<Data>& sets,
                          Eigen::Index count) {
        Eigen::VectorXd column(count);
        Eigen::Index begin = 0;
        for (std::size_t q = 0; q < quantities.size(); ++q) {
            const dynamics::StaticModel before(model, quantities[q]), after(moved, quantities[q]);
            for (const dynamics::Conditions& at : sets[q].at) {
                column(begin++) = (after(at) - before(at)) / step / sigma.at(quantities[q]);
            }
        }
        return column;
    };
    for (const dynamics::Effect* effect : dynamics::effects()) {
        const dynamics::EffectInfo& info = effect->info();
        if (info.seen_in == dynamics::SeenIn::time_series || info.takes_table || info.takes_parameter ||
            info.name == "cable_buoyancy") {
            continue;  // a cable's column is a strut's
        }
        std::vector<std::string> meant{""};
        if (info.takes_quantity && quantities.size() > 1) {
            meant.insert(meant.end(), quantities.begin(), quantities.end());
        }
        for (std::size_t k = 0; k < info.parameters.size(); ++k) {
            const dynamics::EffectParameter& parameter = info.parameters[k];
            if (parameter.shape) {
                continue;
            }
            for (const std::string& quantity : meant) {
                dynamics::EffectUse use = dynamics::neutral_use(info.name);
                use.quantity = quantity;
                const double step = 0.01 * parameter.typical;
                use.values[k] += step;
                const dynamics::Model moved = model.with_effect(use);
                const Eigen::VectorXd column = fill(moved, step, data, rows);
                if (!column.allFinite() || column.norm() < 1e-9) {
                    continue;
                }
                library.conservativeResize(Eigen::NoChange, library.cols() + 1);
                there.conservativeResize(Eigen::NoChange, there.cols() + 1);
                library.rightCols(1) = column / column.norm();
                there.rightCols(1) = fill(moved, step, other, test_rows) / column.norm();
                names.push_back(info.name);
            }
        }
    }
    Eigen::VectorXd y(rows), z(test_rows);
    Eigen::Index begin = 0, from = 0;
    for (std::size_t q = 0; q < quantities.size(); ++q) {
        y.segment(begin, data[q].residual.size()) = data[q].residual;
        z.segment(from, other[q].residual.size()) = other[q].residual;
        begin += data[q].residual.size();
        from += other[q].residual.size();
    }
    const Eigen::VectorXd chosen = thresholded_least_squares(library, y);
    std::set<std::string> found;
    for (Eigen::Index k = 0; k < chosen.size(); ++k) {
        if (chosen(k) != 0) {
            found.insert(names[static_cast<std::size_t>(k)]);
        }
    }
    answer.names.assign(found.begin(), found.end());
    answer.verdict = found.empty() ? "none" : "effect";
    const Eigen::VectorXd left = z - there * chosen;
    from = 0;
    for (std::size_t q = 0; q < quantities.size(); ++q) {
        answer.rmse[quantities[q]] = rmse(left.segment(from, other[q].residual.size()), sigma.at(quantities[q]));
        from += other[q].residual.size();
    }
    return answer;
}

PeerAnswer polynomial_residual(const dynamics::Model& model, const dynamics::Measurements& train,
                               const dynamics::Measurements& test, const Noise& sigma) {
    PeerAnswer answer;
    answer.verdict = "none";
    for (const std::string& quantity : quantities_of(train)) {
        const Data data = data_of(model, train, quantity, sigma.at(quantity));
        const Data other = data_of(model, test, quantity, sigma.at(quantity));
        const Scaled scaled(data, varying(data));
        const Polynomial fit = fit_polynomial(scaled(data), data.residual);
        if (fit.degree >= 0) {
            answer.verdict = "unknown";
        }
        answer.rmse[quantity] = rmse(other.residual - fit.at(scaled(other)), sigma.at(quantity));
    }
    return answer;
}

PeerAnswer gaussian_process_discrepancy(const dynamics::Model& model, const dynamics::Measurements& train,
                                        const dynamics::Measurements& test, const Noise& sigma) {
    PeerAnswer answer;
    answer.verdict = "none";
    for (const std::string& quantity : quantities_of(train)) {
        const Data data = data_of(model, train, quantity, sigma.at(quantity));
        const Data other = data_of(model, test, quantity, sigma.at(quantity));
        const Scaled scaled(data, varying(data));
        const GaussianProcess fit = fit_gaussian_process(scaled(data), data.residual);
        if (!fit.found) {
            answer.rmse[quantity] = rmse(other.residual, sigma.at(quantity));
            continue;
        }
        answer.verdict = "unknown";
        answer.rmse[quantity] = rmse(other.residual - fit.at(scaled(other)), sigma.at(quantity));
        for (std::size_t v = 0; v < scaled.channels.size(); ++v) {
            const std::string name = dynamics::channel_name(scaled.channels[v]);
            if (fit.depends_on(v) &&
                std::find(answer.depends_on.begin(), answer.depends_on.end(), name) == answer.depends_on.end()) {
                answer.depends_on.push_back(name);
            }
        }
    }
    return answer;
}

}  // namespace underbody::bench
