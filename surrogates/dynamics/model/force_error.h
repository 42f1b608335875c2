// How sure a model is of a force: the errors of its tables and of its effects' parameters, as they reach the force.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/model/source_shares.h"

namespace underbody::dynamics {

/// One standard deviation of static_value, N or N m, to first order. Errors of one table file are one error, those of
/// different files and of the effects' parameters are independent; the table of a correction counts as one more file.
/// Immutable, safe to use from many threads.
class ForceError {
public:
    ForceError(const Model& model, const std::string& quantity);
    /// At a set point, as static_value takes it; 0 where neither tables nor effects state an error.
    [[nodiscard]] double operator()(const Conditions& set_point) const;
    /// Neither tables nor effects state an error.
    [[nodiscard]] bool none() const { return sources_.empty() && parameters_.empty() && corrections_.empty(); }

private:
    struct Source {
        std::size_t share = 0;  ///< index into shares_.sources()
        std::size_t group = 0;  ///< of those with the same table file
    };
    struct Parameter {
        StaticModel above, below;  ///< the value moved by `sigma`, as far as its bounds allow
        double share = 0;          ///< of 2 sigma that lies between the two
    };
    StaticModel model_;
    std::string quantity_;
    SourceShares shares_;
    std::vector<Source> sources_;  ///< whose tables state an error
    std::size_t groups_ = 0;
    std::vector<Parameter> parameters_;
    std::vector<std::pair<tables::ForceTable, std::vector<Channel>>> corrections_;
};

/// A model with one number of an effect a standard deviation higher and lower, as far as its bounds allow.
struct ModelsBeside {
    Model above, below;
    double apart = 0;
};
/// Nothing where that number states no error or its bounds leave no room.
std::optional<ModelsBeside> models_beside(const Model& model, std::size_t effect, std::size_t parameter);

/// The model with its force tables drawn anew from their errors (tables of one file by one draw) and every number of
/// its effects from its own deviation, within its bounds. Draws with the same seed and number are the same.
Model drawn_model(const Model& model, std::uint64_t seed, std::size_t draw);

}  // namespace underbody::dynamics
