#include "surrogates/discovery/made_again.h"

#include <nlohmann/json.hpp>

namespace underbody::discovery {

std::optional<estimator::MadeAgain> make_again(Discovery& found, const dynamics::Model& declared,
                                               const dynamics::Measurements& data, core::Progress& progress) {
    if (found.verdict == "none") {
        return {};
    }
    estimator::MadeAgain again = estimator::make_again(declared, found.model, data, progress);
    for (core::Figure& figure : again.figures()) {
        found.figures.push_back(std::move(figure));
    }
    found.made_again = std::make_shared<const nlohmann::json>(again);
    return again;
}

}  // namespace underbody::discovery
