#include "surrogates/tables/search/limits_alone.h"

#include "core/no_limit.h"

namespace underbody::tables {

std::vector<std::optional<LimitAlone>> limits_alone(const SearchProblem& problem,
                                                    const std::map<std::string, Surrogate>& surrogates, double sigmas,
                                                    std::uint64_t seed, core::Progress& progress) {
    std::vector<std::optional<LimitAlone>> result;
    for (const Limit& limit : problem.limits) {
        SearchProblem alone = problem;
        Objective inside{limit.response, Objective::Sense::target, 0.5 * (limit.lower + limit.upper)};
        if (!core::is_limit(limit.upper)) {
            inside.sense = Objective::Sense::maximise;
        } else if (!core::is_limit(limit.lower)) {
            inside.sense = Objective::Sense::minimise;
        }
        alone.objectives = {inside};
        alone.limits = {limit};
        auto found = DesignSearch(alone, surrogates).optimum(sigmas, seed, progress);
        const bool met = found.has_value();
        if (!met) {
            alone.limits.clear();
            found = DesignSearch(alone, surrogates).optimum(0, seed, progress);
        }
        result.push_back(found ? std::optional(LimitAlone{met, found->objectives.front()}) : std::nullopt);
    }
    return result;
}

}  // namespace underbody::tables
