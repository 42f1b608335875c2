// An effect that is what its description says and what it changes: most of the catalogue.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "surrogates/dynamics/model/effect.h"

namespace underbody::dynamics {

/// True when `use` is meant for this quantity.
inline bool concerns(const EffectUse& use, const std::string& quantity) {
    return use.quantity.empty() || use.quantity == quantity;
}
/// The same of an effect that is one of the lift where no quantity is named.
inline bool concerns_lift(const EffectUse& use, const std::string& quantity) {
    return quantity == (use.quantity.empty() ? "lift_force" : use.quantity);
}

/// What an effect does; what is left out does nothing (see Effect).
struct EffectLaw {
    bool (*look)(const SearchContext& context, std::vector<EffectParameter>& parameters, double& prior) = nullptr;
    void (*add_to)(HeaveTerms& terms, const EffectUse& use, const Model& model) = nullptr;
    void (*before)(StaticPoint& point, const EffectUse& use) = nullptr;
    double (*after)(const std::string& quantity, double value, const StaticPoint& seen, const Conditions& set_point,
                    const EffectUse& use) = nullptr;
    std::vector<double> (*kinks)(Channel channel, const EffectUse& use) = nullptr;
};

class LawEffect final : public Effect {
public:
    LawEffect(EffectInfo info, const EffectLaw& law) : info_(std::move(info)), law_(law) {}

    [[nodiscard]] const EffectInfo& info() const override { return info_; }
    [[nodiscard]] bool look(const SearchContext& context, std::vector<EffectParameter>& parameters,
                            double& prior) const override {
        return law_.look == nullptr || law_.look(context, parameters, prior);
    }
    void add_to(HeaveTerms& terms, const EffectUse& use, const Model& model) const override {
        if (law_.add_to != nullptr) {
            law_.add_to(terms, use, model);
        }
    }
    void before(StaticPoint& point, const EffectUse& use) const override {
        if (law_.before != nullptr) {
            law_.before(point, use);
        }
    }
    [[nodiscard]] double after(const std::string& quantity, double value, const StaticPoint& seen,
                               const Conditions& set_point, const EffectUse& use) const override {
        return law_.after == nullptr ? value : law_.after(quantity, value, seen, set_point, use);
    }
    [[nodiscard]] std::vector<double> kinks(Channel channel, const EffectUse& use) const override {
        return law_.kinks == nullptr ? std::vector<double>{} : law_.kinks(channel, use);
    }

private:
    EffectInfo info_;
    EffectLaw law_;
};

}  // namespace underbody::dynamics
