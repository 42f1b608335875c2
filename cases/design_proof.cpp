#include "cases/design_proof.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "cases/design_curves.h"
#include "core/text.h"
#include "core/told.h"
#include "geometry/body/variants.h"
#include "surrogates/tables/search/curve_forces.h"

namespace underbody::cases {

using tables::Response;
using tables::ResponseValue;
using tables::SearchVariable;

namespace {

/// What a point is made of along one condition: one value with the whole weight, or the two about it.
struct Shares {
    std::vector<std::pair<double, double>> values;  ///< value and weight; empty: out of reach
};

Shares shares_of(std::vector<double> known, double wanted) {
    std::sort(known.begin(), known.end());
    constexpr double same = 1e-9;
    for (std::size_t i = 0; i < known.size(); ++i) {
        if (std::abs(known[i] - wanted) <= same * std::max(1e-6, std::abs(wanted)) + 1e-15) {
            return {{{known[i], 1}}};
        }
        if (i > 0 && known[i - 1] < wanted && wanted < known[i]) {
            const double share = (wanted - known[i - 1]) / (known[i] - known[i - 1]);
            return {{{known[i - 1], 1 - share}, {known[i], share}}};
        }
    }
    return {};
}

/// The runs of one design on one fidelity.
class OwnRuns {
public:
    OwnRuns(const Design& design, const std::string& name, const std::string& fidelity)
        : all_(design.spec().all_variables()), shape_(design.spec().variables.size()) {
        for (const DesignRun& run : design.runs()) {
            if (run.usable() && run.design == name && run.fidelity == fidelity) {
                runs_.push_back(&run);
            }
        }
    }

    /// The values of a condition that were run.
    [[nodiscard]] std::vector<double> values(const std::string& condition) const {
        std::set<double> found;
        for (std::size_t v = shape_; v < all_.size(); ++v) {
            for (const DesignRun* run : runs_) {
                if (all_[v].name == condition) {
                    found.insert(run->at[v]);
                }
            }
        }
        return {found.begin(), found.end()};
    }

    /// Adds `weight` times the quantity at the conditions to the weights of runs. False: out of reach.
    bool add(const std::map<std::string, double>& at, double weight,
             std::map<const DesignRun*, double>& weights) const {
        std::vector<Shares> shares;
        for (std::size_t v = shape_; v < all_.size(); ++v) {
            std::vector<double> known;
            for (const DesignRun* run : runs_) {
                known.push_back(run->at[v]);
            }
            shares.push_back(shares_of(std::move(known), at.at(all_[v].name)));
            if (shares.back().values.empty()) {
                return false;
            }
        }
        return add_corner(shares, {}, weight, weights);
    }

private:
    bool add_corner(const std::vector<Shares>& shares, const std::vector<double>& corner, double weight,
                    std::map<const DesignRun*, double>& weights) const {
        if (corner.size() < shares.size()) {
            const auto& values = shares[corner.size()].values;
            return std::all_of(values.begin(), values.end(), [&](const auto& one) {
                std::vector<double> further = corner;
                further.push_back(one.first);
                return add_corner(shares, further, weight * one.second, weights);
            });
        }
        for (const DesignRun* run : runs_) {
            if (std::equal(corner.begin(), corner.end(), run->at.begin() + static_cast<std::ptrdiff_t>(shape_))) {
                weights[run] += weight;
                return true;
            }
        }
        return false;
    }

    std::vector<SearchVariable> all_;
    std::size_t shape_;
    std::vector<const DesignRun*> runs_;
};

using Weights = std::map<const DesignRun*, double>;

struct WeightedSums {
    std::vector<double> value, covariance;  ///< covariance [i * sums + j], of the stated errors of the runs
};

/// Nothing where one of the runs lacks the load.
std::optional<WeightedSums> weighted_sums(const std::vector<Weights>& sums, const std::string& quantity) {
    WeightedSums result{std::vector<double>(sums.size(), 0.0), std::vector<double>(sums.size() * sums.size(), 0.0)};
    for (std::size_t i = 0; i < sums.size(); ++i) {
        for (const auto& [run, weight] : sums[i]) {
            const auto load = run->loads.find(quantity), sigma = run->sigmas.find(quantity);
            if (load == run->loads.end()) {
                return {};
            }
            result.value[i] += weight * load->second;
            for (std::size_t j = 0; sigma != run->sigmas.end() && j < sums.size(); ++j) {
                const auto other = sums[j].find(run);
                result.covariance[i * sums.size() + j] +=
                    other == sums[j].end() ? 0 : weight * other->second * sigma->second * sigma->second;
            }
        }
    }
    return result;
}

/// Of the curves through a design's own runs, as `table equilibria` goes through such points.
std::optional<ResponseValue> computed_curve(const Design& design, const OwnRuns& own, std::map<std::string, double> at,
                                            const tables::CurveAsked& asked) {
    constexpr std::size_t fewest = 3;
    const auto along = asked.runs_over();
    const auto nodes = [&](const std::string& condition) {
        return std::find(along.begin(), along.end(), condition) == along.end() ? std::vector<double>{0}
                                                                               : own.values(condition);
    };
    tables::CurveForces forces{nodes("gap"), nodes("pitch"), {}, {}};
    forces.between = tables::SlopeRule::monotone;
    std::vector<Weights> weights;
    for (const double pitch : forces.pitches) {
        for (const double gap : forces.gaps) {
            for (const std::string& condition : along) {
                at[condition] = condition == "gap" ? gap : pitch;
            }
            weights.emplace_back();
            if (!own.add(at, 1, weights.back())) {
                return {};
            }
        }
    }
    for (const std::string& condition : along) {
        const auto own_nodes = nodes(condition);
        const auto& asked_nodes = condition == "gap" ? design.spec().gaps : design.spec().pitches;
        if (own_nodes.size() < std::max(fewest, asked_nodes.size())) {  // a part of the curve is no curve
            return {};
        }
    }
    tables::CurveErrors errors;
    const auto take = [&](bool asked_for, const std::string& quantity, std::vector<double>& values,
                          std::vector<double>& covariance) {
        const auto sums = asked_for ? weighted_sums(weights, quantity) : WeightedSums{};
        values = sums ? sums->value : std::vector<double>{};
        covariance = sums ? sums->covariance : std::vector<double>{};
        return sums.has_value();
    };
    if (!take(asked.net_weight.has_value(), "lift_force", forces.lift, errors.lift) ||
        !take(asked.of_moment(), asked.moment, forces.moment, errors.moment)) {
        return {};
    }
    const tables::CurveNumber number = curve_number(asked, forces);
    return ResponseValue{number.value, curve_sigma(asked, forces, errors), number.at_least};
}

/// Why there is nothing to compare; empty: there are runs.
std::string missing_words(const Design& design, const PlannedDesign& planned) {
    if (planned.predicted_of != design.what_is_asked()) {
        return "predicted of another shape or water, or for other conditions, objectives or limits, than [design] has "
               "now";
    }
    if (planned.state != "planned") {
        return planned.state;
    }
    std::string failed;
    for (const DesignRun& run : design.runs()) {
        if (run.design == planned.name && run.fidelity == planned.fidelity && run.counts()) {
            if (run.usable()) {
                return {};
            }
            failed = run.state;
        }
    }
    return failed.empty() ? "not computed yet" : failed;
}

}  // namespace

double ProofOfResponse::difference_in_sigmas() const {
    // By how much a number of curves is missed is told in shares of what was known at that time.
    const bool missed = of_curves && computed && std::min(predicted.value, computed->value) < 0;
    const double joint = computed && !missed ? std::hypot(predicted.sigma, computed->sigma) : 0;
    return joint > 0 ? (computed->value - predicted.value) / joint : std::nan("");
}

std::optional<ResponseValue> computed_response(const Design& design, const std::string& name,
                                               const std::string& fidelity, const Response& response) {
    const OwnRuns own(design, name, fidelity);
    std::map<std::string, double> at;
    for (const auto& condition : response.conditions) {
        at[condition.name] = condition.value;
    }
    if (response.curve) {
        return computed_curve(design, own, std::move(at), *response.curve);
    }
    std::map<const DesignRun*, double> weights;
    if (response.slope_along.empty()) {
        if (!own.add(at, 1, weights)) {
            return {};
        }
    } else {
        const double middle = at[response.slope_along];
        for (const double side : {-1.0, 1.0}) {
            at[response.slope_along] = middle + side * response.half_width;
            if (!own.add(at, side / (2 * response.half_width), weights)) {
                return {};
            }
        }
    }
    const auto sum = weighted_sums({weights}, response.quantity);
    return sum ? std::optional(ResponseValue{sum->value.front(), std::sqrt(sum->covariance.front())}) : std::nullopt;
}

std::vector<ProofOfDesign> proofs(const Design& design) {
    std::vector<ProofOfDesign> all;
    for (const PlannedDesign& planned : design.plan()) {
        if (planned.predicted.empty() && planned.predicted_of.empty()) {
            continue;
        }
        ProofOfDesign proof{planned.name, planned.fidelity, planned.why, missing_words(design, planned), {}};
        for (const Response& response : design.spec().responses()) {
            const auto said = planned.predicted.find(response.name);
            if (proof.note.empty() && said != planned.predicted.end()) {
                proof.responses.push_back({response.name, response_unit(response), said->second,
                                           computed_response(design, planned.name, planned.fidelity, response),
                                           response.curve.has_value()});
            }
        }
        all.push_back(std::move(proof));
    }
    return all;
}

std::vector<core::Figure> proof_figures(const std::vector<ProofOfDesign>& all) {
    std::map<std::string, core::Figure> by_unit;
    for (const ProofOfDesign& proof : all) {
        for (const ProofOfResponse& one : proof.responses) {
            if (!one.computed) {
                continue;
            }
            const std::string unit(core::told_unit(one.unit));
            const auto shown = [&](double value) { return core::convert(value, one.unit, unit); };
            core::Figure& figure = by_unit[unit];
            auto series = std::find_if(figure.points.begin(), figure.points.end(),
                                       [&](const auto& points) { return points.name == one.name; });
            if (series == figure.points.end()) {
                figure.points.push_back({one.name, {}, {}, {}, core::palette(figure.points.size())});
                series = std::prev(figure.points.end());
            }
            series->x.push_back(shown(one.computed->value));
            series->y.push_back(shown(one.predicted.value));
            series->y_error.push_back(2 * shown(std::hypot(one.predicted.sigma, one.computed->sigma)));
        }
    }
    std::vector<core::Figure> figures;
    for (auto& [unit, figure] : by_unit) {
        figure.title = "Chosen designs: predicted before they were computed";
        figure.caption = "Bars are two standard deviations, of prediction and run together.";
        figure.x = {"computed", unit};
        figure.y = {"predicted", unit};
        double low = 1e300, high = -1e300;
        for (const auto& points : figure.points) {
            for (std::size_t i = 0; i < points.x.size(); ++i) {
                low = std::min({low, points.x[i], points.y[i]});
                high = std::max({high, points.x[i], points.y[i]});
            }
        }
        core::FigureCurve equal;
        equal.name = "equal";
        equal.x = equal.y = {low, high};
        equal.dashed = true;
        equal.colour = {120, 120, 120, 255};
        figure.curves.push_back(std::move(equal));
        figures.push_back(std::move(figure));
    }
    return figures;
}

std::string proof_text(const ProofOfDesign& proof) {
    const std::string head = proof.design + " (" + proof.fidelity + "): ";
    if (!proof.note.empty()) {
        return head + proof.note + "\n";
    }
    std::string text;
    for (const ProofOfResponse& one : proof.responses) {
        text += head + one.name + " predicted " + told_response(one.predicted, one.of_curves, one.unit);
        if (!one.computed) {
            text += ", its runs do not tell it\n";
            continue;
        }
        const double apart = one.difference_in_sigmas();
        text += ", computed " + told_response(*one.computed, one.of_curves, one.unit) +
                (std::isfinite(apart) ? " (" + core::format_number(std::abs(apart), 2) + " standard deviations apart)"
                                      : std::string()) +
                "\n";
    }
    return text;
}

void to_json(nlohmann::json& json, const ProofOfDesign& proof) {
    json = {{"design", proof.design},
            {"fidelity", proof.fidelity},
            {"why", proof.why},
            {"note", proof.note},
            {"responses", nlohmann::json::array()}};
    for (const ProofOfResponse& one : proof.responses) {
        const auto value = [&](const ResponseValue& v) {
            nlohmann::json told = {{"value", v.value}, {"sigma", v.sigma}};
            if (one.of_curves) {
                told["at_least"] = v.at_least;
            }
            return told;
        };
        json["responses"].push_back({{"name", one.name},
                                     {"unit", one.unit},
                                     {"predicted", value(one.predicted)},
                                     {"computed", one.computed ? value(*one.computed) : nlohmann::json()}});
    }
}

}  // namespace underbody::cases
