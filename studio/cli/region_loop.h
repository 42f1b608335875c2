// The options of `underbody region` that put an estimator with its sensors into the loop.
#pragma once

#include <string>

#include "surrogates/dynamics/basin/region.h"

namespace CLI {
class App;
}

namespace underbody::studio {

class Shell;

struct RegionLoopOptions {
    std::string observer, step, gap_noise, velocity_noise, feedback_on = "estimated";
    double rate = 4;
    bool cancel = false, no_velocity = false;

    void add_to(CLI::App& command);
    [[nodiscard]] bool given() const { return !observer.empty(); }
    /// Throws core::UsageError for one of the options without an estimator.
    void check() const;
};

/// One row a start of the map, with the warnings so far as comments.
core::Table commented_map(const dynamics::StabilityRegion& region, Shell& shell);

/// The map of a loop with its estimator; with `draws` the chance that it holds from each start over the sensors' noise.
/// `options.feedback` is the law.
int run_region_with_estimator(const RegionLoopOptions& a, const dynamics::Model& model,
                              const dynamics::RegionOptions& options, std::size_t draws, std::uint64_t seed,
                              const std::string& picture, const std::string& table, Shell& shell);

}  // namespace underbody::studio
