#include <cmath>
#include <nlohmann/json.hpp>

#include "core/random.h"
#include "core/text.h"
#include "surrogates/dynamics/region.h"
#include "surrogates/dynamics/region_parts.h"

namespace underbody::dynamics {

namespace {

/// The model with every force table drawn anew from its error.
Model drawn(const Model& model, std::uint64_t seed, std::size_t draw) {
    Model result = model;
    core::Random random(seed, draw);
    for (ForceSource& source : result.forces) {
        source.table = source.table.drawn(random.bits());
    }
    return result;
}

}  // namespace

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
    map.safe.assign(options.columns * options.rows, 0.0F);
    RegionOptions each = options;
    each.refine = false;
    // All draws share the bounds of the declared model: a drawn table has the same range.
    double sum = 0, squares = 0;
    for (std::size_t draw = 0; draw < draws; ++draw) {
        progress.check();
        progress.report(static_cast<double>(draw) / static_cast<double>(draws), "drawing force tables");
        const StabilityRegion region = stability_region(drawn(model, seed, draw), each, progress);
        std::size_t safe = 0;
        for (std::size_t i = 0; i < region.index.size(); ++i) {
            const bool back = region.classes[static_cast<std::size_t>(region.index[i])].kind == EndKind::attractor;
            map.safe[i] += back ? 1.0F : 0.0F;
            safe += back ? 1 : 0;
        }
        const double share = static_cast<double>(safe) / static_cast<double>(region.index.size());
        sum += share;
        squares += share * share;
    }
    const auto count = static_cast<double>(draws);
    for (float& value : map.safe) {
        value /= static_cast<float>(draws);
    }
    map.area_mean = sum / count;
    map.area_sigma =
        draws > 1 ? std::sqrt(std::max(0.0, squares / count - map.area_mean * map.area_mean) * count / (count - 1))
                  : 0.0;
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
            {"area_sigma", map.area_sigma}};
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
            set.gap = region.classes[i].gap;
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
    const bool gap_first = region.axes[0].name == "gap";
    const core::NamedRange& gaps = gap_first ? region.axes[0] : region.axes[1];
    const core::NamedRange& speeds = gap_first ? region.axes[1] : region.axes[0];
    const std::size_t columns = gap_first ? region.columns : region.rows,
                      rows = gap_first ? region.rows : region.columns;
    const double dh = (gaps.upper - gaps.lower) / static_cast<double>(columns),
                 dw = (speeds.upper - speeds.lower) / static_cast<double>(rows);
    // Cells that do not end there, relative to the equilibrium; the border of the map counts as not known to be safe.
    std::vector<std::pair<double, double>> bad;
    for (std::size_t j = 0; j < rows; ++j) {
        for (std::size_t i = 0; i < columns; ++i) {
            const int found = region.index[gap_first ? j * columns + i : i * rows + j];
            if (found != wanted) {
                bad.emplace_back(std::abs(gaps.lower + dh * (static_cast<double>(i) + 0.5) - set.gap) - dh / 2,
                                 std::abs(speeds.lower + dw * (static_cast<double>(j) + 0.5)) - dw / 2);
            }
        }
    }
    const double most_gap = std::min(set.gap - gaps.lower, gaps.upper - set.gap),
                 most_speed = std::min(-speeds.lower, speeds.upper);
    // For each half axis in gap the largest in velocity; keep the largest area.
    for (int k = 1; k <= 400; ++k) {
        const double a = most_gap * k / 400;
        double b = most_speed, box = most_speed;
        for (const auto& [x, y] : bad) {
            const double px = std::max(x, 0.0), py = std::max(y, 0.0);
            if (px < a) {
                b = std::min(b, py / std::sqrt(1 - px / a * (px / a)));
                box = std::min(box, py);
            }
        }
        if (b > 0 && a * b > set.ellipse_gap * set.ellipse_velocity) {
            set.ellipse_gap = a;
            set.ellipse_velocity = b;
        }
        if (box > 0 && a * box > (set.box_gap_upper - set.box_gap_lower) / 2 * set.box_velocity) {
            set.box_gap_lower = set.gap - a;
            set.box_gap_upper = set.gap + a;
            set.box_velocity = box;
        }
    }
    return set;
}

void to_json(nlohmann::json& json, const SafeSet& set) {
    json = {
        {"equilibrium", set.equilibrium},
        {"gap", set.gap},
        {"ellipse", {{"gap", set.ellipse_gap}, {"heave_velocity", set.ellipse_velocity}}},
        {"box",
         {{"gap_lower", set.box_gap_lower}, {"gap_upper", set.box_gap_upper}, {"heave_velocity", set.box_velocity}}}};
}

}  // namespace underbody::dynamics
