#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/basin/region_parts.h"
#include "surrogates/dynamics/model/force_error.h"

namespace underbody::dynamics {

void take_mean(ProbabilityMap& map, double sum, double squares) {
    const auto count = static_cast<double>(map.draws);
    for (float& value : map.safe) {
        value /= static_cast<float>(map.draws);
    }
    map.area_mean = sum / count;
    map.area_sigma =
        map.draws > 1 ? std::sqrt(std::max(0.0, squares / count - map.area_mean * map.area_mean) * count / (count - 1))
                      : 0.0;
}

ProbabilityMap probability_map(const Model& model, const RegionOptions& options, std::size_t draws, std::uint64_t seed,
                               core::Progress& progress) {
    if (draws < 1) {
        throw core::UsageError("range", "a probability map needs at least one draw");
    }
    ProbabilityMap map;
    map.axes = options.axes;
    map.columns = options.columns;
    map.rows = options.rows;
    map.draws = draws;
    map.gap_by_ratio = options.gap_by_ratio;
    map.safe.assign(options.columns * options.rows, 0.0F);
    RegionOptions each = options;
    each.refine = false;
    // All draws share the bounds of the declared model: a drawn table has the same range.
    double sum = 0, squares = 0;
    std::string range;
    std::optional<core::Problem> escapes_return;
    for (std::size_t draw = 0; draw < draws; ++draw) {
        progress.check();
        progress.report(static_cast<double>(draw) / static_cast<double>(draws), "drawing force tables");
        const StabilityRegion region = stability_region(drawn_model(model, seed, draw), each, progress);
        map.path_outside_fraction += region.path_outside_fraction / static_cast<double>(draws);
        range = table_range_text(region.table_lower, region.table_upper, region.pitch_lower, region.pitch_upper);
        escapes_return = escapes_return ? escapes_return : region.escapes_return;
        for (std::size_t i = 0; i < region.index.size(); ++i) {
            const bool back = region.classes[static_cast<std::size_t>(region.index[i])].kind == EndKind::attractor;
            map.safe[i] += back ? 1.0F : 0.0F;
        }
        double share = 0;  // of the area
        for (const EndClass& end : region.classes) {
            share += end.kind == EndKind::attractor ? end.fraction : 0;
        }
        sum += share;
        squares += share * share;
    }
    take_mean(map, sum, squares);
    add_path_remark(map.remarks, map.path_outside_fraction, range);
    if (escapes_return) {
        map.remarks.push_back(*escapes_return);
    }
    if (map.area_sigma == 0) {
        map.remarks.push_back(
            {core::Problem::Severity::note, "the force tables carry no error, or none that matters here", {}});
    }
    return map;
}

void to_json(nlohmann::json& json, const ProbabilityMap& map) {
    json = {{"columns", map.columns},
            {"rows", map.rows},
            {"draws", map.draws},
            {"area_mean", map.area_mean},
            {"area_sigma", map.area_sigma},
            {"outside_table_path_fraction", map.path_outside_fraction},
            {"remarks", nlohmann::json::array()}};
    for (const core::Problem& remark : map.remarks) {
        json["remarks"].push_back(remark.message);
    }
    json["axes"] = nlohmann::json::array();
    for (const core::NamedRange& axis : map.axes) {
        json["axes"].push_back({{"name", axis.name}, {"lower", axis.lower}, {"upper", axis.upper}});
    }
    json["safe"] = map.safe;
}

SafeSet largest_safe_set(const StabilityRegion& region, const std::string& equilibrium) {
    SafeSet set;
    set.equilibrium = equilibrium;
    int wanted = -1;
    for (std::size_t i = 0; i < region.classes.size(); ++i) {
        if (region.classes[i].name == equilibrium && region.classes[i].kind == EndKind::attractor) {
            wanted = static_cast<int>(i);
        }
    }
    if (wanted < 0) {
        std::vector<std::string> known;
        for (const EndClass& end : region.classes) {
            if (end.kind == EndKind::attractor) {
                known.push_back(end.name);
            }
        }
        throw core::InputError("name", "no attractor is called '" + equilibrium + "'", {},
                               core::did_you_mean(equilibrium, known));
    }
    for (const HeaveEquilibrium& e : region.equilibria) {
        if (e.name == equilibrium) {
            for (const std::size_t axis : {0, 1}) {
                const std::string& name = region.axes[axis].name;
                set.axes[axis] = name;
                set.centre[axis] = name == "gap" ? e.gap : name == "pitch" ? e.pitch : 0.0;
            }
        }
    }
    const core::NamedRange &ax = region.axes[0], &ay = region.axes[1];
    const auto edge = [&](const core::NamedRange& axis, std::size_t i, std::size_t count) {
        return place_along(axis, region.gap_by_ratio, static_cast<double>(i) / static_cast<double>(count));
    };
    // Cells that do not end there, relative to the equilibrium; the border of the map counts as not known to be safe.
    std::vector<std::pair<double, double>> bad;
    for (std::size_t k = 0; k < region.index.size(); ++k) {
        if (region.index[k] != wanted) {
            const std::size_t i = k % region.columns, j = k / region.columns;
            const auto away = [](double centre, double lower, double upper) {
                return std::max({0.0, lower - centre, centre - upper});
            };
            bad.emplace_back(away(set.centre[0], edge(ax, i, region.columns), edge(ax, i + 1, region.columns)),
                             away(set.centre[1], edge(ay, j, region.rows), edge(ay, j + 1, region.rows)));
        }
    }
    const double most_x = std::min(set.centre[0] - ax.lower, ax.upper - set.centre[0]),
                 most_y = std::min(set.centre[1] - ay.lower, ay.upper - set.centre[1]);
    // For each half length along the first axis the largest along the second; keep the largest area.
    for (int k = 1; k <= 400; ++k) {
        const double a = most_x * k / 400;
        double b = most_y, box = most_y;
        for (const auto& [x, y] : bad) {
            if (x < a) {
                b = std::min(b, y / std::sqrt(1 - x / a * (x / a)));
                box = std::min(box, y);
            }
        }
        if (a > 0 && b > 0 && a * b > set.ellipse[0] * set.ellipse[1]) {
            set.ellipse = {a, b};
        }
        if (a > 0 && box > 0 && a * box > set.box[0] * set.box[1]) {
            set.box = {a, box};
        }
    }
    return set;
}

void to_json(nlohmann::json& json, const SafeSet& set) {
    json = {{"equilibrium", set.equilibrium},
            {"ellipse", nlohmann::json::object()},
            {"box", nlohmann::json::object()},
            {"centre", nlohmann::json::object()}};
    for (const std::size_t axis : {0, 1}) {
        const std::string& name = set.axes[axis];
        json["centre"][name] = set.centre[axis];
        json["ellipse"][name] = set.ellipse[axis];
        json["box"][name + "_lower"] = set.centre[axis] - set.box[axis];
        json["box"][name + "_upper"] = set.centre[axis] + set.box[axis];
    }
}

}  // namespace underbody::dynamics
