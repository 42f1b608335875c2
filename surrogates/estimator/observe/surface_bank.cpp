#include "surrogates/estimator/observe/surface_bank.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace underbody::estimator {

namespace {

struct Member {
    ExtendedRunner runner;
    double log_weight = 0;
    double squares = 0, count = 0;  // of normalised innovations
};

void normalise(std::vector<Member>& bank) {
    double top = -INFINITY, sum = 0;
    for (const Member& m : bank) {
        top = std::max(top, m.log_weight);
    }
    for (const Member& m : bank) {
        sum += std::exp(m.log_weight - top);
    }
    for (Member& m : bank) {
        m.log_weight -= top + std::log(sum);
    }
}

Vector prior_of(const std::vector<Surface>& surfaces, const SurfaceOptions& options) {
    if (options.prior.empty()) {
        return Vector(surfaces.size(), 1.0 / static_cast<double>(surfaces.size()));
    }
    double sum = 0;
    for (const double p : options.prior) {
        sum += p >= 0 ? p : NAN;
    }
    if (options.prior.size() != surfaces.size() || !(sum > 0)) {
        throw core::InputError("range", "the prior wants one probability per surface, none negative");
    }
    Vector prior = options.prior;
    for (double& p : prior) {
        p /= sum;
    }
    return prior;
}

// Chance of a change over dt: each surface's weight leaks to the prior, its density kept.
void leak(std::vector<Member>& bank, const Vector& prior, std::size_t densities, double stay) {
    for (std::size_t d = 0; d < densities; ++d) {
        double sum = 0;
        for (std::size_t s = 0; s < prior.size(); ++s) {
            sum += std::exp(bank[s * densities + d].log_weight);
        }
        for (std::size_t s = 0; s < prior.size(); ++s) {
            double& w = bank[s * densities + d].log_weight;
            w = std::log(stay * std::exp(w) + (1 - stay) * sum * prior[s]);
        }
    }
}

}  // namespace

std::vector<double> usual_densities(double largest_force) {
    // A walk that covers 0.03 % to 30 % of the largest force in a second.
    std::vector<double> densities;
    for (double part = 3e-4; part < 0.5; part *= std::sqrt(10.0)) {
        densities.push_back(part * part * largest_force * largest_force);
    }
    return densities;
}

namespace {

/// The surface that is likeliest at the end, and the force density that is likeliest with it.
void judge(SurfaceProbability& result, const std::vector<Member>& bank, const Vector& densities) {
    for (std::size_t s = 1; s < result.names.size(); ++s) {
        result.best = result.probability[s].back() > result.probability[result.best].back() ? s : result.best;
    }
    const auto first = bank.begin() + static_cast<std::ptrdiff_t>(result.best * densities.size());
    const auto likeliest =
        std::max_element(first, first + static_cast<std::ptrdiff_t>(densities.size()),
                         [](const Member& a, const Member& b) { return a.log_weight < b.log_weight; });
    result.force_density = densities[static_cast<std::size_t>(likeliest - first)];
    result.mean_squared_innovation = likeliest->count > 0 ? likeliest->squares / likeliest->count : NAN;
}

/// A filter for each surface and noise, those of one surface beside each other. They refer to `surfaces` and `noises`.
std::vector<Member> bank_of(const std::vector<Surface>& surfaces, const RunSignals& run, const Vector& prior,
                            const std::vector<FilterNoise>& noises) {
    std::vector<Member> bank;
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
        for (const FilterNoise& noise : noises) {
            bank.push_back({ExtendedRunner(surfaces[s].plant, noise)});
            bank.back().runner.start(start_of_run(bank.back().runner, run, noise));
            bank.back().log_weight = std::log(prior[s] / static_cast<double>(noises.size()));
        }
    }
    return bank;
}

}  // namespace

SurfaceProbability identify_surface(const std::vector<Surface>& surfaces, const RunSignals& run,
                                    const SurfaceOptions& options) {
    if (surfaces.size() < 2) {
        throw core::InputError("few", "at least two surfaces are wanted to tell apart");
    }
    check_run(run);
    const Vector prior = prior_of(surfaces, options);
    const Vector densities = options.densities.empty() ? Vector{options.noise.force_density} : options.densities;
    std::vector<FilterNoise> noises(densities.size(), options.noise);
    for (std::size_t d = 0; d < densities.size(); ++d) {
        noises[d].force_density = densities[d];
    }
    std::vector<Member> bank = bank_of(surfaces, run, prior, noises);
    SurfaceProbability result;
    std::vector<RunSignals> felt;  // per surface: its input behind that model's actuator
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
        result.names.push_back(surfaces[s].name);
        felt.push_back(through_actuator(surfaces[s].plant, run));
    }
    result.time = run.time;
    result.probability.assign(surfaces.size(), std::vector<double>(run.time.size()));
    for (std::size_t k = 0; k < run.time.size(); ++k) {
        const double dt = k > 0 ? run.time[k] - run.time[k - 1] : 0;
        if (k > 0 && options.switching > 0) {
            leak(bank, prior, densities.size(), std::exp(-options.switching * dt));
        }
        for (std::size_t i = 0; i < bank.size(); ++i) {
            Member& m = bank[i];
            FilterEstimate e;
            if (k > 0) {
                m.runner.predict(dt, input_over(felt[i / densities.size()], k), run.time[k - 1]);
            }
            m.log_weight += m.runner.measure(run.gap[k], run.velocity.empty() ? NAN : run.velocity[k], e);
            if (k > 10 && std::isfinite(e.innovation) && !e.outlier) {
                m.squares += e.innovation * e.innovation / (e.innovation_sigma * e.innovation_sigma);
                m.count += 1;
            }
        }
        normalise(bank);
        for (std::size_t i = 0; i < bank.size(); ++i) {
            result.probability[i / densities.size()][k] += std::exp(bank[i].log_weight);
        }
    }
    judge(result, bank, densities);
    return result;
}

}  // namespace underbody::estimator
