// The bank of surfaces over measured runs.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "surrogates/dynamics/simulate/read_records.h"
#include "surrogates/estimator/observe/estimate.h"
#include "surrogates/estimator/observe/surface_bank.h"

namespace underbody::estimator {

namespace {

double largest_force(const SeparatedPlant& plant) {
    double largest = 1e-6, slope = 0;
    for (int i = 0; i <= 200; ++i) {
        largest =
            std::max(largest, std::abs(plant.ground_force(plant.lower + (plant.upper - plant.lower) * i / 200, slope)));
    }
    return largest;
}

}  // namespace

SurfaceReport identify_surfaces(const std::vector<std::pair<std::string, dynamics::Model>>& surfaces,
                                const dynamics::Measurements& data, const FilterNoise& noise, double switching) {
    SurfaceReport report;
    const dynamics::RecordReading records =
        surfaces.empty() ? dynamics::RecordReading{} : dynamics::input_reading(surfaces.front().second, data).records;
    for (const auto& run : data.runs) {
        core::Problems remarks;
        const RunSignals signals = signals_of_run(run, remarks, records);
        std::vector<Surface> bank;
        double largest = 0;
        for (const auto& [name, model] : surfaces) {
            bank.push_back({name, separate(model, dynamics::signals_of(run, records).held)});
            largest = std::max(largest, largest_force(bank.back().plant));
        }
        SurfaceOptions options;
        options.noise = noise;
        options.noise.departure_sigma = 0.02 * largest;
        options.densities = usual_densities(largest);
        options.switching = switching;
        report.runs.push_back(run.name);
        report.of_run.push_back(identify_surface(bank, signals, options));
    }
    return report;
}

std::string SurfaceReport::text() const {
    std::string text;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const SurfaceProbability& p = of_run[r];
        text += runs[r] + ": surface " + p.names[p.best] + ", probability " +
                core::format_number(p.probability[p.best].back(), 4);
        const double misfit = std::sqrt(p.mean_squared_innovation);
        if (misfit > 1.3) {
            text += " among those given, but none fits: its innovations are " + core::format_number(misfit, 3) +
                    " times what it states";
        }
        text += "\n";
    }
    return text;
}

core::Figure SurfaceReport::figure() const {
    core::Figure f;
    f.title = "Which surface is under the vehicle";
    f.caption = "Probability by a bank of filters, one per surface; runs one after another, dashed lines between them.";
    f.x = {"time over the runs", "s", 0, 0, false};
    f.y = {"probability", "1", -0.03, 1.03, false};
    double from = 0;
    std::vector<core::FigureCurve> curves;
    for (std::size_t r = 0; r < of_run.size(); ++r) {
        const SurfaceProbability& p = of_run[r];
        curves.resize(p.names.size());
        for (std::size_t s = 0; s < p.names.size(); ++s) {
            curves[s].name = p.names[s];
            curves[s].colour = core::palette(s);
            for (std::size_t k = 0; k < p.time.size(); ++k) {
                curves[s].x.push_back(from + p.time[k] - p.time.front());
                curves[s].y.push_back(p.probability[s][k]);
            }
            curves[s].x.push_back(NAN);
            curves[s].y.push_back(NAN);
        }
        from += p.time.back() - p.time.front();
        if (r + 1 < of_run.size()) {
            f.lines.push_back({true, from, "", {150, 150, 150, 255}, true});
        }
    }
    f.curves = curves;
    return f;
}

void to_json(nlohmann::json& j, const SurfaceReport& report) {
    j = nlohmann::json::array();
    for (std::size_t r = 0; r < report.runs.size(); ++r) {
        const SurfaceProbability& p = report.of_run[r];
        nlohmann::json probability = nlohmann::json::object();
        for (std::size_t s = 0; s < p.names.size(); ++s) {
            probability[p.names[s]] = p.probability[s].back();
        }
        j.push_back({{"run", report.runs[r]},
                     {"surface", p.names[p.best]},
                     {"probability", probability},
                     {"force_density", p.force_density},
                     {"mean_squared_innovation", p.mean_squared_innovation}});
    }
}

}  // namespace underbody::estimator
