#include "surrogates/discovery/consequence.h"

#include <cmath>

#include "core/no_limit.h"
#include "surrogates/dynamics/basin/region.h"

namespace underbody::discovery {

std::vector<EquilibriumPair> paired(const std::vector<Balance>& before, std::vector<Balance> after) {
    std::vector<EquilibriumPair> pairs;
    for (const Balance& one : before) {
        EquilibriumPair pair{one.name, one.stable, one.gap, std::nan("")};
        const auto distance = [&](const Balance& other) {
            return std::abs(other.gap - one.gap) / core::never_zero(other.gap + one.gap);
        };
        auto nearest = after.end();
        for (auto other = after.begin(); other != after.end(); ++other) {
            if (other->stable == one.stable && (nearest == after.end() || distance(*other) < distance(*nearest))) {
                nearest = other;
            }
        }
        if (nearest != after.end()) {
            pair.gap_after = nearest->gap;
            after.erase(nearest);
        }
        pairs.push_back(pair);
    }
    for (const Balance& one : after) {
        pairs.push_back({one.name, one.stable, std::nan(""), one.gap});
    }
    return pairs;
}

void compare_regions(const dynamics::Model& before, const dynamics::Model& after, double low, double high,
                     const dynamics::Conditions& held, std::size_t cells, core::Progress& progress,
                     Consequence& result) {
    constexpr double speed = 0.1;  // m/s, of the releases whose ends are compared
    dynamics::RegionOptions options;
    options.axes = {{"gap", low, high}, {"heave_velocity", -speed, speed}};
    options.columns = options.rows = cells;
    options.refine = false;
    options.held = held;
    const auto shares = [&](const dynamics::Model& model) {
        std::map<std::string, double> fractions;
        for (const dynamics::EndClass& one : dynamics::stability_region(model, options, progress).classes) {
            fractions[one.name] = one.fraction;
        }
        return fractions;
    };
    result.region_before = shares(before);
    const bool same = after.effects.size() == before.effects.size() && after.changed == before.changed;
    result.region_after = same ? result.region_before : shares(after);
}

void map_if_possible(Consequence& result, const std::function<void()>& map) {
    try {
        map();
    } catch (const core::Cancelled&) {
        throw;
    } catch (const core::Error& error) {
        result.text +=
            (result.text.empty() ? "" : " ") + std::string("The free motion could not be mapped: ") + error.message();
    }
}

}  // namespace underbody::discovery
