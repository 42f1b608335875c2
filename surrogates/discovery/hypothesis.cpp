#include "surrogates/discovery/hypothesis.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::discovery {

using dynamics::Channel;

namespace {

constexpr double off_declared = 0.2;  ///< typical values beside a declared number at which its search begins
constexpr double off_neutral = 0.3;   ///< and beside the value at which an effect does nothing
constexpr double typical_exponent = 0.2;
constexpr double typical_share = 0.1;  ///< of a declared factor
constexpr double least_factor = 1e-6;  ///< a declared factor of nothing is searched as if it were this
constexpr double lowest_share = 0.05, highest_share = 20;  ///< of a declared factor: beyond it is another rig
constexpr double named_prior = 0.05;                       ///< of a declared number whose effect has a name of its own

/// What a search looks at, and how the effects answer it.
struct Look {
    const dynamics::Model& model;
    const std::vector<Channel>& varying;
    const std::vector<std::string>& quantities;  ///< measured
    bool time_series = false;
    bool pitches = false;  ///< heave with pitch
    bool slides = false;   ///< on the ground
    bool turns = false;    ///< on the ground, or the whole body
    /// As an effect sees it, asked about these quantities.
    [[nodiscard]] dynamics::SearchContext context(const std::vector<std::string>& asked) const {
        return {model, asked, varying, time_series, pitches, slides, turns};
    }
};

/// False where the effect can change nothing there.
bool add_use(Hypothesis& hypothesis, const dynamics::Effect& effect, const std::string& quantity, const Look& look) {
    const dynamics::EffectInfo& info = effect.info();
    const std::vector<std::string> own{quantity};
    std::vector<dynamics::EffectParameter> parameters = info.parameters;
    if (!effect.look(look.context(quantity.empty() ? look.quantities : own), parameters, hypothesis.prior)) {
        return false;
    }
    dynamics::EffectUse use = dynamics::neutral_use(info.name);
    use.quantity = quantity;
    const std::size_t which = hypothesis.uses.size();
    for (std::size_t k = 0; k < parameters.size(); ++k) {
        const dynamics::EffectParameter& p = parameters[k];
        use.values[k] = p.neutral;
        if (p.lower == p.upper) {
            continue;  // held
        }
        hypothesis.parameters.push_back({p.name, p.unit, p.lower, p.upper, p.neutral, p.typical});
        hypothesis.slots.push_back({which, k});
    }
    hypothesis.uses.push_back(std::move(use));
    return true;
}

/// Starts on both sides of neutral and, for shapes, a factor of three either way.
void add_starts(Hypothesis& hypothesis) {
    std::vector<std::vector<double>> starts{{}};
    for (std::size_t j = 0; j < hypothesis.parameters.size(); ++j) {
        const FitParameter& p = hypothesis.parameters[j];
        const dynamics::EffectInfo& info = dynamics::effect(hypothesis.uses[hypothesis.slots[j].use].name).info();
        const bool shape = info.parameters[hypothesis.slots[j].value].shape;
        std::vector<double> values;
        if (shape) {
            values = {p.start, p.start - p.typical, p.start + p.typical};
        } else {
            values = {p.start + 0.5 * p.typical, p.start - 0.5 * p.typical};
        }
        std::vector<std::vector<double>> longer;
        for (const std::vector<double>& begun : starts) {
            for (const double value : values) {
                if (value >= p.lower && value <= p.upper) {
                    longer.push_back(begun);
                    longer.back().push_back(value);
                }
            }
        }
        if (longer.size() <= 9) {
            starts = std::move(longer);
        } else {
            for (std::vector<double>& begun : starts) {
                begun.push_back(shape ? p.start : std::min(p.start + 0.5 * p.typical, p.upper));
            }
        }
    }
    hypothesis.starts = std::move(starts);
}

Hypothesis make(const dynamics::Effect& effect, const std::vector<std::string>& quantities, const std::string& form,
                const Look& look) {
    Hypothesis hypothesis;
    hypothesis.names = {effect.info().name};
    hypothesis.form = form;
    hypothesis.depends_on = effect.info().depends_on;
    hypothesis.prior = effect.info().search.prior;
    double prior = hypothesis.prior;
    for (const std::string& quantity : quantities) {
        hypothesis.prior = effect.info().search.prior;
        add_use(hypothesis, effect, quantity, look);
        prior = hypothesis.prior;  // of one use: the same effect on several quantities is no less likely
    }
    hypothesis.prior = prior;
    add_starts(hypothesis);
    const dynamics::EffectInfo& info = effect.info();
    if (info.seen_in == dynamics::SeenIn::static_set && !info.search.starts.empty() && hypothesis.uses.size() == 1) {
        hypothesis.starts = info.search.starts;
    }
    return hypothesis;
}

/// The catalogue speaks of lift; where something else was measured the hypothesis speaks of that. Numbers that are
/// forces are moments where all that they act on are moments.
void speak_of(Hypothesis& hypothesis, const std::vector<std::string>& quantities) {
    const auto lift = std::find(hypothesis.depends_on.begin(), hypothesis.depends_on.end(), "lift_force");
    if (lift != hypothesis.depends_on.end() &&
        std::find(quantities.begin(), quantities.end(), "lift_force") == quantities.end()) {
        *lift = quantities.front();
    }
    for (std::size_t j = 0; j < hypothesis.parameters.size(); ++j) {
        const dynamics::EffectUse& use = hypothesis.uses[hypothesis.slots[j].use];
        const std::vector<std::string> concerned =
            use.quantity.empty() ? quantities : std::vector<std::string>{use.quantity};
        std::string& unit = hypothesis.parameters[j].unit;
        if ((unit == "N" || unit == "N/s") &&
            std::all_of(concerned.begin(), concerned.end(),
                        [](const std::string& name) { return name.ends_with("moment"); })) {
            unit.insert(1, " m");
        }
    }
}

bool varies(const std::vector<Channel>& varying, const std::string& name) {
    Channel channel{};
    return dynamics::find_channel(name, channel) && std::find(varying.begin(), varying.end(), channel) != varying.end();
}

/// Whether a static set with these channels can show an effect against this model at all.
bool can_be_seen(const dynamics::Effect& effect, const Look& look) {
    const dynamics::EffectSearch& search = effect.info().search;
    const auto moves = [&](const std::string& name) { return varies(look.varying, name); };
    std::vector<dynamics::EffectParameter> parameters = effect.info().parameters;
    double prior = 1;
    return std::all_of(search.needs.begin(), search.needs.end(), moves) &&
           (search.needs_one_of.empty() ||
            std::any_of(search.needs_one_of.begin(), search.needs_one_of.end(), moves)) &&
           effect.look(look.context(look.quantities), parameters, prior);
}

/// The effect that puts another value in the place of a declared number.
const dynamics::EffectInfo& declared_number() {
    for (const dynamics::Effect* effect : dynamics::effects()) {
        if (effect->info().takes_parameter) {
            return effect->info();
        }
    }
    throw core::InputError("name", "no effect of the catalogue corrects a declared number", {}, {});
}

/// The second strength of each use bound to the first, so that there is one.
void one_strength(Hypothesis& hypothesis) {
    for (std::size_t j = hypothesis.slots.size(); j-- > 0;) {
        if (hypothesis.slots[j].value == 1) {
            hypothesis.copies.push_back({j - 1, hypothesis.slots[j]});  // the first stands before it
            hypothesis.parameters[j - 1].upper =
                std::min(hypothesis.parameters[j - 1].upper, hypothesis.parameters[j].upper);
            hypothesis.parameters.erase(hypothesis.parameters.begin() + static_cast<std::ptrdiff_t>(j));
            hypothesis.slots.erase(hypothesis.slots.begin() + static_cast<std::ptrdiff_t>(j));
        }
    }
    for (Hypothesis::Copy& copy : hypothesis.copies) {
        const auto first = std::find_if(
            hypothesis.slots.begin(), hypothesis.slots.end(),
            [&](const Hypothesis::Slot& slot) { return slot.use == copy.to.use && slot.value + 1 == copy.to.value; });
        copy.parameter = static_cast<std::size_t>(first - hypothesis.slots.begin());
    }
    add_starts(hypothesis);
}

Hypothesis of_declared(const std::string& parameter, double declared, double lower, double upper, double typical,
                       const std::vector<std::string>& depends_on) {
    Hypothesis hypothesis;
    const std::string& name = declared_number().name;
    hypothesis.names = {name};
    dynamics::EffectUse use = dynamics::neutral_use(name);
    use.parameter = parameter;
    use.values[0] = declared;
    hypothesis.form = parameter;
    hypothesis.uses = {use};
    hypothesis.parameters = {{"value", "1", lower, upper, declared, typical}};
    hypothesis.slots = {{0, 0}};
    hypothesis.starts = {{declared + off_declared * typical}};
    hypothesis.depends_on = depends_on;
    return hypothesis;
}

/// Declared numbers for which the catalogue has no name of its own: the factor of one of several sources of a quantity,
/// and powers of channels other than the speed and the voltage of a declared jet.
std::vector<Hypothesis> declared_numbers(const dynamics::Model& model, const std::vector<Channel>& varying,
                                         const std::vector<std::string>& quantities) {
    std::vector<Hypothesis> list;
    for (std::size_t k = 0; k < model.forces.size(); ++k) {
        const dynamics::ForceSource& source = model.forces[k];
        if (std::find(quantities.begin(), quantities.end(), source.quantity) == quantities.end()) {
            continue;
        }
        const std::string prefix = "force." + std::to_string(k + 1) + ".";
        std::vector<std::string> depends_on;
        for (const Channel axis : source.axes) {
            depends_on.emplace_back(dynamics::channel_name(axis));
        }
        const auto sources =
            std::count_if(model.forces.begin(), model.forces.end(),
                          [&](const dynamics::ForceSource& other) { return other.quantity == source.quantity; });
        for (const dynamics::ForceScale& scale : source.scales) {
            const std::string name = dynamics::channel_name(scale.channel);
            depends_on.push_back(name);
            const bool named =
                scale.channel == Channel::speed || (scale.channel == Channel::jet_voltage && scale.exponent != 0);
            if ((!named || (scale.channel == Channel::speed && sources > 1)) && varies(varying, name)) {
                list.push_back(of_declared(prefix + "scale." + name + ".exponent", scale.exponent, -10, 10,
                                           typical_exponent, {name}));
                list.back().prior = named ? named_prior : 1;  // the power of the speed has a name of its own
            }
        }
        if (sources > 1) {
            list.push_back(of_declared(prefix + "factor", source.factor, -1000, 1000,
                                       typical_share * std::max(std::abs(source.factor), least_factor), depends_on));
        }
    }
    return list;
}

}  // namespace

std::vector<dynamics::EffectUse> Hypothesis::with(std::span<const double> p) const {
    std::vector<dynamics::EffectUse> result = uses;
    for (std::size_t j = 0; j < slots.size(); ++j) {
        result[slots[j].use].values[slots[j].value] = p[j];
    }
    for (const Copy& copy : copies) {
        result[copy.to.use].values[copy.to.value] = p[copy.parameter];
    }
    return result;
}

std::vector<double> Hypothesis::start() const {
    std::vector<double> p;
    for (const FitParameter& parameter : parameters) {
        p.push_back(parameter.start);
    }
    return p;
}

std::string Hypothesis::label() const {
    std::string text;
    for (const std::string& name : names) {
        text += (text.empty() ? "" : " + ") + name;
    }
    return text.empty() ? "none" : text;
}

std::vector<Hypothesis> static_hypotheses(const dynamics::Model& model, const std::vector<Channel>& varying,
                                          const std::vector<std::string>& quantities) {
    const Look look{model, varying, quantities, false};
    std::vector<Hypothesis> list;
    for (const dynamics::Effect* effect : dynamics::effects()) {
        const dynamics::EffectInfo& info = effect->info();
        if (info.seen_in == dynamics::SeenIn::time_series || info.takes_table || info.takes_parameter ||
            !can_be_seen(*effect, look)) {
            continue;
        }
        const std::size_t first = list.size();
        const bool lift_only = info.search.lift_unless_named;
        list.push_back(
            make(*effect, {""}, quantities.size() > 1 && !lift_only ? "same for all measured quantities" : "", look));
        if (info.takes_quantity && quantities.size() > 1) {
            for (const std::string& quantity : quantities) {
                if (!lift_only || quantity != "lift_force") {
                    list.push_back(make(*effect, {quantity}, quantity + " only", look));
                }
            }
            list.push_back(make(*effect, quantities, "each measured quantity with its own number", look));
        }
        if (!info.search.one_strength_form.empty()) {
            list.push_back(make(*effect, {""}, info.search.one_strength_form, look));
            one_strength(list.back());
        }
        for (std::size_t k = first; k < list.size(); ++k) {
            speak_of(list[k], quantities);
        }
        std::erase_if(list, [](const Hypothesis& one) { return one.uses.empty(); });
    }
    for (Hypothesis& hypothesis : declared_numbers(model, varying, quantities)) {
        list.push_back(std::move(hypothesis));
    }
    return list;
}

namespace {

/// Starts of a time series: the effect's own, or a little off neutral.
void start_heave(Hypothesis& hypothesis, const dynamics::EffectSearch& search) {
    hypothesis.starts = search.starts;
    if (search.starts.empty() && !search.scanned) {
        hypothesis.starts.emplace_back();
        for (const FitParameter& p : hypothesis.parameters) {
            hypothesis.starts.front().push_back(std::min(p.start + off_neutral * p.typical, p.upper));
        }
    }
}

}  // namespace

namespace {

/// With this number held where it is by default: dearer numbers that weak effects do not show would hide them.
Hypothesis without(Hypothesis hypothesis, const std::string& number) {
    const auto held = std::find_if(hypothesis.parameters.begin(), hypothesis.parameters.end(),
                                   [&](const FitParameter& p) { return p.name == number; }) -
                      hypothesis.parameters.begin();
    hypothesis.parameters.erase(hypothesis.parameters.begin() + held);
    hypothesis.slots.erase(hypothesis.slots.begin() + held);
    for (std::vector<double>& begin : hypothesis.starts) {
        begin.erase(begin.begin() + held);
    }
    return hypothesis;
}

/// Every effect that time series can show, in the catalogue's order.
std::vector<Hypothesis> series_hypotheses(const Look& look) {
    std::vector<Hypothesis> list;
    for (const dynamics::Effect* effect : dynamics::effects()) {
        const dynamics::EffectInfo& info = effect->info();
        if (info.seen_in == dynamics::SeenIn::static_set || info.takes_table || info.takes_parameter) {
            continue;
        }
        Hypothesis hypothesis = make(*effect, {""}, "", look);
        if (hypothesis.uses.empty()) {
            continue;
        }
        start_heave(hypothesis, info.search);
        if (!info.search.also_held.empty()) {
            list.push_back(without(hypothesis, info.search.also_held));
        }
        if (!info.search.beside.empty()) {
            // the law is not one law; with the other's numbers free its form bends to others
            Hypothesis bent = hypothesis;
            bent.form = info.search.beside_form;
            const std::size_t own = bent.parameters.size();
            add_use(bent, dynamics::effect(info.search.beside), "", look);
            for (std::vector<double>& begin : bent.starts) {
                for (std::size_t j = own; j < bent.parameters.size(); ++j) {
                    begin.push_back(bent.parameters[j].start);
                }
            }
            list.push_back(std::move(bent));
        }
        list.push_back(std::move(hypothesis));
    }
    return list;
}

/// The scale of the only force table of a quantity and its exponents are the declared numbers that have no name of
/// their own in the catalogue.
void add_declared_scale(const Look& look, const std::string& quantity, std::vector<Hypothesis>& list) {
    std::size_t sources = 0;
    std::size_t which = 0;
    for (std::size_t k = 0; k < look.model.forces.size(); ++k) {
        if (look.model.forces[k].quantity == quantity) {
            ++sources;
            which = k;
        }
    }
    if (sources != 1) {
        return;
    }
    const dynamics::ForceSource& source = look.model.forces[which];
    const std::string prefix = "force." + std::to_string(which + 1) + ".";
    list.push_back(of_declared(prefix + "factor", source.factor, lowest_share * source.factor,
                               highest_share * source.factor, typical_share * source.factor, {"gap"}));
    for (const dynamics::ForceScale& scale : source.scales) {
        if (std::find(look.varying.begin(), look.varying.end(), scale.channel) != look.varying.end()) {
            const std::string channel = dynamics::channel_name(scale.channel);
            list.push_back(of_declared(prefix + "scale." + channel + ".exponent", scale.exponent, -6, 10,
                                       typical_exponent, {"gap", channel}));
        }
    }
}

bool acts_on_the_ground(const Hypothesis& hypothesis, const dynamics::Model& model) {
    dynamics::HeaveTerms terms;
    for (dynamics::EffectUse use : hypothesis.uses) {
        for (std::size_t j = 0; j < use.values.size(); ++j) {
            use.values[j] += 0.1 * dynamics::effect(use.name).info().parameters[j].typical;
        }
        dynamics::effect(use.name).add_to(terms, use, model);
    }
    return !(terms.surface == dynamics::SurfaceTerms{});
}

}  // namespace

std::vector<Hypothesis> heave_hypotheses(const dynamics::Model& model, const std::vector<Channel>& varying) {
    const std::vector<std::string> lift{"lift_force"};
    const Look look{model, varying, lift, true};
    std::vector<Hypothesis> list = series_hypotheses(look);
    add_declared_scale(look, lift.front(), list);
    return list;
}

std::vector<Hypothesis> motion_hypotheses(const dynamics::MotionShape& shape, const dynamics::Model& model,
                                          const std::vector<Channel>& varying) {
    std::vector<std::string> quantities;
    for (const dynamics::MotionShape::Load& load : shape.loads) {
        quantities.push_back(load.quantity);
    }
    const bool whole = &shape == &dynamics::body_motion().shape(),
               pitches = whole || &shape == &dynamics::heave_pitch_motion().shape(),
               slides = &shape == &dynamics::surface_motion().shape();
    const Look look{model, varying, quantities, true, pitches, slides, whole || slides};
    std::vector<Hypothesis> list = series_hypotheses(look);
    if (slides) {
        std::erase_if(list, [&](const Hypothesis& one) { return !acts_on_the_ground(one, model); });
    }
    std::vector<std::string> tables = quantities;
    if (whole) {
        tables.emplace_back("drag_force");
    }
    for (const std::string& quantity : tables) {
        add_declared_scale(look, quantity, list);
        if (!list.empty() && list.back().form.starts_with("force.") && quantity == "pitch_moment") {
            list.back().depends_on.emplace_back("pitch");
        }
    }
    return list;
}

void keep_only(std::vector<Hypothesis>& list, const std::vector<std::string>& names) {
    if (names.empty()) {
        return;
    }
    std::erase_if(list, [&](const Hypothesis& h) {
        return !std::all_of(h.names.begin(), h.names.end(), [&](const std::string& own) {
            return std::find(names.begin(), names.end(), own) != names.end();
        });
    });
    if (list.empty()) {
        throw core::InputError("option", "none of the candidates asked for can be seen in such data", {},
                               "leave the list of candidates out to have all tried");
    }
}

Hypothesis joined(const Hypothesis& a, std::span<const double> start_a, const Hypothesis& b,
                  std::span<const double> start_b) {
    const auto scales = [](const Hypothesis& h) {
        return dynamics::effect(h.names.front()).info().search.scales_reading;
    };
    if (scales(b) && !scales(a)) {
        // a gain acts on the force, then comes what is added to the reading: with both linear a fit cannot get caught
        // on its way to a small gain
        return joined(b, start_b, a, start_a);
    }
    Hypothesis both = a;
    for (std::size_t j = 0; j < both.parameters.size(); ++j) {
        both.parameters[j].start = start_a[j];
    }
    const std::size_t offset = a.uses.size();
    both.uses.insert(both.uses.end(), b.uses.begin(), b.uses.end());
    for (std::size_t j = 0; j < b.parameters.size(); ++j) {
        both.parameters.push_back(b.parameters[j]);
        both.parameters.back().start = start_b[j];
        both.slots.push_back({b.slots[j].use + offset, b.slots[j].value});
    }
    std::set<std::string> names(a.names.begin(), a.names.end());
    names.insert(b.names.begin(), b.names.end());
    both.names.assign(names.begin(), names.end());
    for (const Hypothesis::Copy& copy : b.copies) {
        both.copies.push_back({copy.parameter + a.parameters.size(), {copy.to.use + offset, copy.to.value}});
    }
    std::set<std::string> depends(a.depends_on.begin(), a.depends_on.end());
    depends.insert(b.depends_on.begin(), b.depends_on.end());
    both.depends_on.assign(depends.begin(), depends.end());
    both.form = a.form.empty() ? b.form : b.form.empty() ? a.form : a.form + "; " + b.form;
    both.prior = a.prior * b.prior;
    both.starts.clear();
    return both;
}

Touch touch_of(const Hypothesis& hypothesis, const dynamics::Model& model) {
    dynamics::HeaveTerms terms;
    std::vector<double> numbers;
    for (const FitParameter& p : hypothesis.parameters) {
        numbers.push_back(p.start + typical_share * p.typical);
    }
    for (const dynamics::EffectUse& use : hypothesis.with(numbers)) {
        dynamics::effect(use.name).add_to(terms, use, model);
    }
    Touch touch;
    touch.input = !terms.actuator.ideal() || terms.thrust_loss != 0;
    touch.gain = terms.actuator.gain != 1 || terms.pitch.moment_gain != 1 || terms.surface.thrust_gain != 1;
    touch.reading_late = terms.sensor_delay != 0;
    touch.delay = touch.reading_late || terms.actuator.delay != 0;
    touch.time = touch.delay || terms.actuator.lag > 0;
    return touch;
}

bool one_kin(const std::vector<std::string>& names) {
    const auto kin_of = [](const std::string& name) -> const std::vector<std::string>& {
        return dynamics::effect(name).info().search.kin;
    };
    const std::vector<std::string>& first = kin_of(names.front());
    return std::any_of(first.begin(), first.end(), [&](const std::string& kin) {
        return std::all_of(names.begin(), names.end(), [&](const std::string& name) {
            const std::vector<std::string>& own = kin_of(name);
            return std::find(own.begin(), own.end(), kin) != own.end();
        });
    });
}

bool is_scanned(const Hypothesis& hypothesis) {
    return dynamics::effect(hypothesis.names.front()).info().search.scanned;
}

std::vector<std::vector<double>> small_steps(const Hypothesis& h) {
    const std::vector<double> start = h.start();
    if (is_scanned(h)) {
        const double frequency = h.starts.empty() ? start[1] : h.starts.front()[1];
        return {{1e-4, frequency, 0.0}, {1e-4, frequency, std::numbers::pi / 2}};
    }
    std::vector<std::vector<double>> steps;
    const auto step = [&](std::size_t j, double from) {
        const FitParameter& p = h.parameters[j];
        const double size = 0.05 * p.typical;
        return from + size > p.upper ? from - size : from + size;
    };
    for (std::size_t j = 0; j < start.size(); ++j) {
        std::vector<double> p = start;
        if (j > 0) {
            p.front() = step(0, p.front());  // a shape shows only beside a strength
        }
        p[j] = step(j, p[j]);
        steps.push_back(std::move(p));
    }
    return steps;
}

void keep_shapes_inside(std::vector<Hypothesis>& list, double lowest_gap, double lowest_frequency) {
    const double slowest = 2 * lowest_frequency;
    std::erase_if(list, [&](Hypothesis& candidate) {
        for (std::size_t j = 0; j < candidate.parameters.size(); ++j) {
            FitParameter& parameter = candidate.parameters[j];
            const dynamics::EffectUse& use = candidate.uses[candidate.slots[j].use];
            if (is_scanned(candidate) && j == 1) {  // its frequency
                parameter.lower = std::max(parameter.lower, slowest);
                parameter.start = std::max(parameter.start, slowest);
            } else if (dynamics::effect(use.name).info().parameters[candidate.slots[j].value].within_gaps) {
                parameter.lower = std::max(parameter.lower, 0.1 * lowest_gap);
                parameter.start = std::max(parameter.start, parameter.lower);
            }
            if (parameter.lower >= parameter.upper) {
                return true;
            }
        }
        return false;
    });
}

double occam_factor(const Hypothesis& hypothesis, std::size_t data) {
    return static_cast<double>(hypothesis.parameters.size()) *
           std::log(static_cast<double>(std::max<std::size_t>(data, 2)));
}

}  // namespace underbody::discovery
