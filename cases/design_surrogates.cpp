// What a design search makes of its runs: surrogates, the search on them, what is known for it.
#include <algorithm>
#include <cmath>
#include <memory>

#include "cases/design.h"
#include "core/counted.h"
#include "core/error.h"
#include "core/quantile.h"
#include "core/text.h"
#include "core/units.h"

namespace underbody::cases {

using tables::SearchVariable;

tables::Surrogate Design::surrogate(const std::string& quantity, core::Progress& progress) const {
    if (std::find(spec_.quantities.begin(), spec_.quantities.end(), quantity) == spec_.quantities.end()) {
        throw core::InputError("name", "[design] does not compute " + quantity, {},
                               core::did_you_mean(quantity, spec_.quantities));
    }
    if (std::none_of(runs_.begin(), runs_.end(), [](const DesignRun& run) { return run.usable(); })) {
        throw core::InputError("missing",
                               runs_.empty() ? "nothing has been computed yet"
                                             : "of " + core::counted(runs_.size(), "run") +
                                                   " none is solved of what [design] asks for now",
                               {(spec_.folder / "results.csv").string(), {}, {}, {}},
                               "'underbody design plan' and 'design run', or rows of another solver; 'state' says what "
                               "failed");
    }
    std::map<std::string, std::vector<double>> stated;  // by fidelity
    for (const DesignRun& run : runs_) {
        if (run.usable() && run.sigmas.contains(quantity)) {
            stated[run.fidelity].push_back(run.sigmas.at(quantity));
        }
    }
    const auto usual = [&](const std::string& fidelity) {
        const std::vector<double>& sigmas = stated[fidelity];
        return sigmas.empty() ? 0.0 : core::median(sigmas);  // the surrogate estimates a scatter as well
    };
    std::vector<tables::SearchRun> runs;
    for (const DesignRun& run : runs_) {
        const auto load = run.loads.find(quantity), sigma = run.sigmas.find(quantity);
        if (run.usable() && load != run.loads.end()) {
            runs.push_back({run.at, level_of(spec_, run.fidelity, run.design), load->second,
                            sigma == run.sigmas.end() ? usual(run.fidelity) : sigma->second});
        }
    }
    return tables::Surrogate::fit(quantity, core::find_quantity(quantity)->unit, spec_.all_variables(), runs, progress);
}

std::map<std::string, tables::Surrogate> Design::surrogates(core::Progress& progress) const {
    std::map<std::string, tables::Surrogate> result;
    for (const std::string& q : spec_.quantities) {
        result.emplace(q, surrogate(q, progress));
    }
    return result;
}

tables::DesignSearch Design::search(std::map<std::string, tables::Surrogate> surrogates) const {
    tables::SearchProblem problem;
    problem.variables = spec_.variables;
    problem.objectives = spec_.objectives;
    problem.limits = spec_.limits;
    problem.known_limits.push_back(
        [spec = spec_, base = base_](std::span<const double> at) { return broken_by(spec, base, at); });
    return {std::move(problem), std::move(surrogates)};
}

tables::DesignSearch::NextOptions Design::known() const {
    tables::DesignSearch::NextOptions options;
    options.seed = spec_.seed + runs_.size();
    for (const FidelitySpec& fidelity : spec_.fidelities) {
        options.level_costs.push_back(fidelity.cost);
    }
    std::map<std::vector<double>, bool> solved;
    for (const DesignRun& run : runs_) {
        if (!run.counts()) {
            continue;
        }
        const std::vector<double> at(run.at.begin(),
                                     run.at.begin() + static_cast<std::ptrdiff_t>(spec_.variables.size()));
        auto [entry, fresh] = solved.try_emplace(at, run.usable());
        entry->second = entry->second && run.usable();
    }
    for (const auto& [at, good] : solved) {
        (good ? options.solved : options.failed).push_back(at);
    }
    for (const PlannedDesign& design : plan_) {
        const bool run = std::any_of(runs_.begin(), runs_.end(), [&](const DesignRun& r) {
            return r.other.empty() && r.design == design.name && r.fidelity == design.fidelity;
        });
        if (design.state == "planned" && !run) {
            options.planned.emplace_back(design.at, level_of(spec_, design.fidelity, design.name));
        }
    }
    return options;
}

std::optional<tables::TrustRegion> Design::trust_region(const tables::DesignSearch& search) const {
    if (spec_.variables.size() <= tables::trust_region_from) {
        return {};
    }
    tables::TrustRegion region;
    double best = std::nan("");
    for (const PlannedDesign& design : plan_) {
        const bool run = std::any_of(runs_.begin(), runs_.end(),
                                     [&](const DesignRun& r) { return r.design == design.name && r.usable(); });
        const double value = run ? search.best_of({design.at}) : std::nan("");
        // A thousandth of the best is no improvement (Eriksson et al. 2019).
        const bool improved = std::isnan(best) ? !std::isnan(value) : value < best - 1e-3 * std::abs(best);
        best = std::fmin(best, value);
        if (design.why != "plan" && run) {
            region.step(improved, spec_.variables.size());
            region = region.collapsed() ? tables::TrustRegion{} : region;
        }
    }
    return region;
}

geometry::BodyShape Design::shape_at(const std::vector<double>& at) const { return cases::shape_at(spec_, base_, at); }

LearnedNumber::LearnedNumber(const tables::Surrogate& surrogate)
    : name(surrogate.quantity()),
      unit(surrogate.unit()),
      variables(surrogate.variables()),
      value([surrogate](std::span<const double> x) { return surrogate.at(x).value; }),
      with_error([surrogate](std::span<const double> x) {
          const auto p = surrogate.at(x);
          return tables::ResponseValue{p.value, p.sigma};
      }) {}

std::vector<LearnedNumber> learned_numbers(const Design& design,
                                           const std::map<std::string, tables::Surrogate>& surrogates) {
    std::vector<LearnedNumber> all;
    for (const auto& [name, surrogate] : surrogates) {
        all.emplace_back(surrogate);
    }
    std::shared_ptr<const tables::DesignSearch> search;
    for (const tables::Response& response : design.spec().responses()) {
        if (!response.curve || design.spec().objectives.empty()) {
            continue;
        }
        if (!search) {
            search = std::make_shared<const tables::DesignSearch>(design.search(surrogates));
        }
        LearnedNumber one;
        one.name = response.name;
        one.unit = response_unit(response);
        one.of_curves = true;
        one.variables = design.spec().variables;
        one.value = [search, response](std::span<const double> x) { return search->evaluate_alone(response, x).value; };
        one.with_error = [search, response](std::span<const double> x) { return search->evaluate(response, x); };
        all.push_back(std::move(one));
    }
    return all;
}

tables::SobolIndices Design::sensitivity(const LearnedNumber& number) const {
    const auto& variables = number.variables;
    return tables::sobol_indices(
        [&](std::span<const double> u) {
            std::vector<double> x;
            for (std::size_t v = 0; v < variables.size(); ++v) {
                x.push_back(variables[v].unscaled(u[v]));
            }
            return number.value(x);
        },
        variables.size(), 1024, spec_.seed);
}

}  // namespace underbody::cases
