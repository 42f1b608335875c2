#include "surrogates/estimator/observe/made_again.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/no_limit.h"
#include "surrogates/dynamics/plant/contact_gap.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "surrogates/dynamics/simulate/read_records.h"
#include "surrogates/estimator/observe/estimate.h"

namespace underbody::estimator {

namespace {

using dynamics::Channel;

/// Smallest and largest measured gap, at least a millimetre apart and off the ground.
core::NamedRange gaps_of(const dynamics::Model& model, const dynamics::Measurements& data) {
    double low = INFINITY, high = -INFINITY;
    for (const dynamics::MeasuredRun& run : data.runs) {
        for (const double gap : run.has("gap") ? run.values("gap") : std::vector<double>{}) {
            low = std::isfinite(gap) ? std::min(low, gap) : low;
            high = std::isfinite(gap) ? std::max(high, gap) : high;
        }
    }
    const dynamics::GapRange table = dynamics::lift_gap_range(model);
    const bool bounded = core::is_limit(table.lower) && core::is_limit(table.upper);
    if (data.kind == dynamics::MeasurementKind::steady && bounded) {
        low = table.lower;
        high = table.upper;
    }
    if (!(low < high)) {
        throw core::InputError("range", "the data span no range of gaps");
    }
    low = std::max({low, dynamics::contact_gap(model), 1e-4});
    return {"gap", low, std::max(high, low + 1e-3)};
}

dynamics::StabilityRegion map_of(const dynamics::Model& model, const dynamics::Conditions& held,
                                 const core::NamedRange& gaps, core::Progress& progress) {
    dynamics::RegionOptions options;
    options.axes = {gaps, {"heave_velocity", -0.1, 0.1}};
    options.columns = options.rows = 80;
    options.refine = false;
    options.held = held;
    return dynamics::stability_region(model, options, progress);
}

core::Figure separation_figure(const SeparationAlongGap& before, const SeparationAlongGap& after) {
    core::Figure f;
    f.title = "Separation along the gap, before and after";
    f.caption =
        "Ground force that the estimator separates from the same runs with the old and with the new model. Bands: two "
        "standard deviations.";
    f.x = {"gap", "mm", 0, 0, false};
    f.y = {"ground force", "mN", 0, 0, false};
    const auto add = [&](const char* name, const SeparationAlongGap& s, std::size_t colour, bool dashed) {
        core::FigureCurve curve;
        core::FigureBand band;
        curve.name = name;
        curve.colour = core::palette(colour);
        curve.dashed = dashed;
        band.colour = curve.colour;
        band.colour.alpha = 45;
        for (std::size_t i = 0; i < s.gap.size(); ++i) {
            curve.x.push_back(1e3 * s.gap[i]);
            curve.y.push_back(1e3 * s.ground_force[i]);
            band.lower.push_back(1e3 * (s.ground_force[i] - 2 * s.ground_sigma[i]));
            band.upper.push_back(1e3 * (s.ground_force[i] + 2 * s.ground_sigma[i]));
        }
        band.x = curve.x;
        f.bands.push_back(band);
        f.curves.push_back(curve);
    };
    add("before", before, 1, true);
    add("after", after, 0, false);
    return f;
}

}  // namespace

SeparationAlongGap separation_along_gap(const dynamics::Model& model, const dynamics::Measurements& data,
                                        std::size_t bins, core::Progress& progress) {
    const Estimation e = estimate(model, data, {}, progress);
    const std::vector<double>&gap = e.table.numbers("gap"), &ground = e.table.numbers("ground_force"),
          &drag = e.table.numbers("drag_force"), &ground_sigma = e.table.numbers("ground_force_sigma"),
          &drag_sigma = e.table.numbers("drag_force_sigma"), &total_sigma = e.table.numbers("total_force_sigma");
    const auto [low, high] = std::minmax_element(gap.begin(), gap.end());
    struct Bin {
        double count = 0, gap = 0, ground = 0, drag = 0, ground2 = 0, drag2 = 0, total2 = 0;
    };
    std::vector<Bin> all(bins);
    for (std::size_t i = 0; i < gap.size(); ++i) {
        const double place = *high > *low ? (gap[i] - *low) / (*high - *low) * static_cast<double>(bins) : 0;
        Bin& b = all[std::min(static_cast<std::size_t>(place), bins - 1)];
        b.count += 1;
        b.gap += gap[i];
        b.ground += ground[i];
        b.drag += drag[i];
        b.ground2 += ground_sigma[i] * ground_sigma[i];
        b.drag2 += drag_sigma[i] * drag_sigma[i];
        b.total2 += total_sigma[i] * total_sigma[i];
    }
    SeparationAlongGap s;
    for (const Bin& b : all) {
        if (b.count > 0) {
            s.gap.push_back(b.gap / b.count);
            s.ground_force.push_back(b.ground / b.count);
            s.drag_force.push_back(b.drag / b.count);
            s.ground_sigma.push_back(std::sqrt(b.ground2 / b.count));
            s.drag_sigma.push_back(std::sqrt(b.drag2 / b.count));
            s.total_sigma.push_back(std::sqrt(b.total2 / b.count));
        }
    }
    s.force_density = e.noise.force_density;
    s.departure = e.departure_rms;
    double used = 0;
    for (const RunEstimate& run : e.runs) {
        s.mean_squared_innovation += run.mean_squared_innovation * static_cast<double>(run.used);
        used += static_cast<double>(run.used);
    }
    s.mean_squared_innovation /= std::max(used, 1.0);
    return s;
}

MadeAgain make_again(const dynamics::Model& before, const dynamics::Model& after, const dynamics::Measurements& data,
                     core::Progress& progress) {
    MadeAgain again;
    const auto attempt = [&](const char* what, const std::function<void()>& make) {
        try {
            make();
        } catch (const core::Cancelled&) {
            throw;
        } catch (const core::Error& error) {
            again.left_out.push_back(std::string(what) + ": " + error.message());
        }
    };
    if (data.kind == dynamics::MeasurementKind::time_series) {
        attempt("separation along the gap", [&] {
            again.separation_before = separation_along_gap(before, data, 30, progress);
            again.separation_after = separation_along_gap(after, data, 30, progress);
        });
    } else {
        again.left_out.emplace_back("separation along the gap: a static set shows no motion to separate forces from");
    }
    attempt("stability map", [&] {
        const core::NamedRange gaps = gaps_of(before, data);
        const dynamics::Conditions held = data.kind == dynamics::MeasurementKind::time_series
                                              ? dynamics::signals_of(data.runs.front(), before.records).held
                                              : dynamics::Conditions{};
        again.map_before = map_of(before, held, gaps, progress);
        again.map_after = map_of(after, held, gaps, progress);
    });
    return again;
}

std::vector<core::Figure> MadeAgain::figures() const {
    std::vector<core::Figure> all;
    if (separation_before && separation_after) {
        all.push_back(separation_figure(*separation_before, *separation_after));
    }
    if (map_before && map_after) {
        for (const auto& [map, when] : {std::pair{&*map_before, "before"}, std::pair{&*map_after, "after"}}) {
            all.push_back(dynamics::region_figure(*map));
            all.back().title = std::string("Where free motions end, ") + when;
        }
        core::Figure boundaries = dynamics::region_overlay_figure({*map_before, *map_after}, {"before", "after"});
        if (!boundaries.curves.empty()) {  // where all starts end alike there are none
            boundaries.title = "Boundaries of the two maps";
            all.push_back(std::move(boundaries));
        }
    }
    return all;
}

void to_json(nlohmann::json& json, const SeparationAlongGap& s) {
    json = {{"gap", s.gap},
            {"ground_force", s.ground_force},
            {"drag_force", s.drag_force},
            {"ground_force_sigma", s.ground_sigma},
            {"drag_force_sigma", s.drag_sigma},
            {"total_force_sigma", s.total_sigma},
            {"force_density", s.force_density},
            {"departure_rms", s.departure},
            {"mean_squared_innovation", s.mean_squared_innovation}};
}

void to_json(nlohmann::json& json, const MadeAgain& again) {
    json = nlohmann::json::object();
    if (again.separation_before && again.separation_after) {
        json["separation"] = {{"before", *again.separation_before}, {"after", *again.separation_after}};
    }
    if (again.map_before && again.map_after) {
        dynamics::to_json(json["map"]["before"], *again.map_before);
        dynamics::to_json(json["map"]["after"], *again.map_after);
    }
    json["left_out"] = again.left_out;
}

}  // namespace underbody::estimator
