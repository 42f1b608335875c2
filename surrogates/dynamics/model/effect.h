// An effect: physics that a model may lack, as a plug-in. One file each in this folder, one line in registry.cpp;
// simulation, prediction, discovery, help and desktop then know it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "surrogates/dynamics/model/channels.h"
#include "surrogates/tables/fit/force_table.h"

namespace underbody::dynamics {

struct HeaveTerms;  // surrogates/dynamics/plant/heave_terms.h
struct Model;

/// One number of an effect.
struct EffectParameter {
    std::string name;
    std::string unit;  ///< SI; "parameter" for declared_parameter's value, which has the unit of what it corrects
    double lower = 0;  ///< hard bounds, SI: a model file outside them is refused
    double upper = 0;
    double typical = 1;   ///< a plausible size on a vehicle of this kind, > 0: scale of a search, width of a prior
    double neutral = 0;   ///< the value at which the effect vanishes (or, for a shape parameter, its default)
    bool shape = false;   ///< true: says where or how fast, not how much; may be left out of a model file
    std::string meaning;  ///< one line, with the sign
};

enum class SeenIn { time_series, static_set, both };

/// Everything about a kind of effect that is not a number of one use of it.
struct EffectInfo {
    std::string name;     ///< as in model.toml and discovery.json
    std::string title;    ///< for people
    std::string formula;  ///< plain text, with the signs of docs/conventions.md section 1
    SeenIn seen_in = SeenIn::time_series;
    std::vector<std::string> depends_on;  ///< quantity names
    std::vector<EffectParameter> parameters;
    std::string source;            ///< author, year, equation, or "definition"
    bool takes_quantity = false;   ///< may name one measured quantity (`quantity = "lift_force"`); else all of them
    bool takes_table = false;      ///< needs a table of corrections (unknown)
    bool takes_parameter = false;  ///< names a declared parameter of the model (declared_parameter)
    bool belongs_to_the_rig =
        false;  ///< load cell, guide, cable, set-up, water of the tank: goes with the vehicle nowhere
};

inline EffectInfo of_the_rig(EffectInfo info) {
    info.belongs_to_the_rig = true;
    return info;
}

/// One use of an effect in a model.
struct EffectUse {
    std::string name;
    std::vector<double> values;               ///< one per EffectInfo::parameters, SI
    std::vector<double> sigmas;               ///< one standard deviation each; 0 when unknown
    std::string quantity;                     ///< which measured quantity it changes; empty: every one it can
    std::string parameter;                    ///< declared_parameter only: dotted name, e.g. "vehicle.mass"
    std::optional<tables::ForceTable> table;  ///< unknown only: the correction, N, over named variables
    std::string table_file;                   ///< where `table` came from or will be written, relative to the model
};

/// A set point of a static measurement on its way through a model.
struct StaticPoint {
    Conditions conditions;  ///< as the model shall see them
    const Model* model = nullptr;
};

/// Implementations are stateless and live for ever in the registry; they may be used from many threads.
class Effect {
public:
    virtual ~Effect() = default;

    [[nodiscard]] virtual const EffectInfo& info() const = 0;

    /// Time series: adds itself to the compiled terms of the heave equation. Default: nothing.
    virtual void add_to(HeaveTerms& terms, const EffectUse& use, const Model& model) const;
    /// Static: changes the conditions before the model's forces are looked up (gap_offset, current, ...).
    virtual void before(StaticPoint& point, const EffectUse& use) const;
    /// Static: the value of `quantity` after the model's forces were summed. `set_point` is as measured, `seen` as
    /// changed by all `before`s.
    [[nodiscard]] virtual double after(const std::string& quantity, double value, const StaticPoint& seen,
                                       const Conditions& set_point, const EffectUse& use) const;

protected:
    /// True when `use` is meant for this quantity.
    static bool concerns(const EffectUse& use, const std::string& quantity) {
        return use.quantity.empty() || use.quantity == quantity;
    }
};

/// All effects in the order of the catalogue (docs/conventions.md section 6).
const std::vector<const Effect*>& effects();
/// nullptr when there is none of that name.
const Effect* find_effect(std::string_view name);
/// Throws core::InputError with the nearest name.
const Effect& effect(std::string_view name);

/// A use with neutral (shape: default) values and no sigmas; throws for an unknown name.
EffectUse neutral_use(std::string_view name);
/// A use with the given values by name, the others neutral. Throws core::InputError: unknown name, out of bounds.
struct ParameterValue {
    std::string name;
    double value = 0;
    double sigma = 0;
};
EffectUse make_use(std::string_view name, const std::vector<ParameterValue>& values);
/// Throws core::InputError (kind "range") when a value is outside its bounds or not finite.
void check_use(const EffectUse& use, const core::Place& place = {});

}  // namespace underbody::dynamics
