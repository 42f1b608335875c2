// How much of each force table of a quantity reaches the force: the one place where scales, coupling and the effects of
// a model act on its tables.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// The effects that act on the force tables of a quantity in a motion: those of the vehicle, not of the rig. Of the
/// lift without those that stand in the heave equation by themselves (Effect::add_to): roughness and corrections.
std::vector<EffectUse> effects_on_tables(const Model& model, const std::string& quantity);

/// static_value is linear in the tables of its quantity: the sum of share * table and of what no table gives. The
/// shares hold the sources' factors, scales, coupling and every effect of the model. Immutable, safe to use from many
/// threads.
class SourceShares {
public:
    SourceShares(const Model& model, const std::string& quantity);
    /// Indices into Model::forces of the tables of the quantity.
    [[nodiscard]] const std::vector<std::size_t>& sources() const { return sources_; }
    /// Share of the table of sources()[k] at a set point; with `nothing` = without_tables(set_point) where many are
    /// asked at one place.
    [[nodiscard]] double operator()(std::size_t k, const Conditions& set_point) const {
        return (*this)(k, set_point, without_tables(set_point));
    }
    [[nodiscard]] double operator()(std::size_t k, const Conditions& set_point, double nothing) const {
        return alone_[k](set_point) - nothing;
    }
    /// What no table gives, N or N m.
    [[nodiscard]] double without_tables(const Conditions& set_point) const { return nothing_(set_point); }

private:
    std::vector<std::size_t> sources_;
    StaticModel nothing_;
    std::vector<StaticModel> alone_;  ///< one table at 1, the others at 0
};

}  // namespace underbody::dynamics
