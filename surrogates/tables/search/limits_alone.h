// Why a search finds no design: which of its limits cannot be met at all.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "surrogates/tables/search/design_search.h"

namespace underbody::tables {

struct LimitAlone {
    bool met = false;       ///< by some design, whatever the other limits say
    ResponseValue nearest;  ///< its response where it comes nearest: furthest inside, or least outside
};

/// Each limit of a search by itself, met by `sigmas` of its stated error as in DesignSearch::optimum(); empty for a
/// limit where the limits that are known without a run leave no design. Throws as DesignSearch does.
std::vector<std::optional<LimitAlone>> limits_alone(const SearchProblem& problem,
                                                    const std::map<std::string, Surrogate>& surrogates, double sigmas,
                                                    std::uint64_t seed,
                                                    core::Progress& progress = core::Progress::none());

}  // namespace underbody::tables
