// An effect: physics that a model may lack, as a plug-in. One file each in surrogates/dynamics/effects, one line in
// catalogue.h there; simulation, prediction, discovery, help and desktop then know it.
#pragma once

#include <optional>
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
    double typical = 1;        ///< a plausible size on a vehicle of this kind, > 0: scale of a search, width of a prior
    double neutral = 0;        ///< the value at which the effect vanishes (or, for a shape parameter, its default)
    bool shape = false;        ///< true: says where or how fast, not how much; may be left out of a model file
    std::string meaning;       ///< one line, with the sign
    bool within_gaps = false;  ///< a length along the gap: it shows only within the gaps that were measured
};

/// What a search in measurements has to know of an effect beside its law. The defaults suit a strength that is fitted
/// from a little off neutral.
struct EffectSearch {
    std::vector<std::string> needs{};         ///< channels that must vary in a static set
    std::vector<std::string> needs_one_of{};  ///< of these at least one
    /// Numbers that fits begin at, each of the length of the parameters; of an effect that time series show, theirs
    /// alone. Empty: a little off neutral.
    std::vector<std::vector<double>> starts{};
    std::string adds_to{};            ///< declared numbers of the model that its law is beside: "drag.heave", "contact"
    std::vector<std::string> kin{};   ///< groups of effects that can stand in for parts of each other
    bool one_sign = false;            ///< of one kin and of opposite signs two of them are one law that neither has
    double prior = 1;                 ///< before the data were seen
    bool scanned = false;             ///< amplitude, frequency, phase: its starts come from a scan over frequency
    bool lift_unless_named = false;   ///< changes lift_force alone where a use names no quantity
    std::string also_held{};          ///< time series: tried once more with this number held where it is by default
    bool scales_reading = false;      ///< of two at once it acts on what the other leaves
    std::string same_law_as{};        ///< another name for the law of this effect: the rig tells which it is
    std::string beside{};             ///< time series: tried once more with this other effect's numbers free
    std::string beside_form{};        ///< and what that form is called
    std::string one_strength_form{};  ///< static sets: tried once more with the second strength bound to the first
    /// Another form that the law may have as well: its difference goes into the errors of the numbers.
    void (*other_form)(HeaveTerms&) = nullptr;
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
    EffectSearch search{};
};

inline EffectInfo searched(EffectInfo info, EffectSearch search) {
    info.search = std::move(search);
    return info;
}

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

/// What a search knows when it asks an effect whether and where to look for it.
struct SearchContext {
    const Model& model;
    const std::vector<std::string>& quantities;  ///< measured (static sets), or the one that a use names
    const std::vector<Channel>& varying;
    bool time_series = false;
    bool pitches = false;  ///< the body's pitch moves with its heave, and was measured
    bool slides = false;   ///< the body moves on the ground
    bool turns = false;    ///< it moves along and across itself and in yaw: on the ground or off it
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

    /// Values of a channel at which the forces bend by it, beside those at which tables do. Default: none.
    [[nodiscard]] virtual std::vector<double> kinks(Channel channel, const EffectUse& use) const;

    /// False where the effect can change nothing that was measured of this model. Else narrows bounds, moves neutral
    /// values and the prior to what is possible on this vehicle; equal bounds hold a number. Default: true, nothing
    /// narrowed.
    [[nodiscard]] virtual bool look(const SearchContext& context, std::vector<EffectParameter>& parameters,
                                    double& prior) const;

protected:
    /// True when `use` is meant for this quantity.
    static bool concerns(const EffectUse& use, const std::string& quantity) {
        return use.quantity.empty() || use.quantity == quantity;
    }
};

/// All effects in the order of the catalogue (docs/conventions.md section 6).
const std::vector<const Effect*>& effects();
/// As long as it lives, an effect that is not of the catalogue is known like the others. Not to be made or destroyed
/// while another thread uses the catalogue. Throws core::InputError when the name is taken.
class RegisteredEffect {
public:
    explicit RegisteredEffect(const Effect& effect);
    ~RegisteredEffect();
    RegisteredEffect(const RegisteredEffect&) = delete;
    RegisteredEffect& operator=(const RegisteredEffect&) = delete;

private:
    const Effect& effect_;
};
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
