#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/no_limit.h"
#include "core/text.h"
#include "surrogates/dynamics/model/drag.h"
#include "surrogates/dynamics/model/force_sources.h"
#include "surrogates/dynamics/plant/contact_gap.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/plant/resting_gaps.h"

namespace underbody::dynamics {

namespace {

constexpr double everywhere = 1e6;  ///< m: a force that no gap changes holds up to there

bool contains(const std::vector<Channel>& list, Channel channel) {
    return std::find(list.begin(), list.end(), channel) != list.end();
}

/// The value of an axis that is not the gap, when nothing varies it.
double held_value(const ForceSource& source, std::size_t axis, const Conditions& held, const Model& model) {
    const Channel channel = source.axes[axis];
    if (held.has(channel)) {
        return held[channel];
    }
    if (channel == Channel::pitch || channel == Channel::pitch_rate || channel == Channel::heave_velocity) {
        return 0;
    }
    throw core::InputError(
        "missing", std::string("nothing says the ") + channel_name(channel) + ", an axis of " + source.table_file,
        {model.name, {}, {}, {}}, "give it as a condition, or under [conditions] in the model");
}

/// `seen`: the held conditions as the effects of the model let the tables see them.
HeaveSource compile(const ForceSource& source, const Model& model, const Conditions& held, const Conditions& seen,
                    const std::vector<Channel>& varying) {
    HeaveSource compiled;
    compiled.factor = source.factor;
    for (const ForceScale& scale : source.scales) {
        compiled.scales.push_back({scale.channel, scale.reference, scale.exponent, scale.dead_band,
                                   held.get(scale.channel, scale.reference)});
    }
    if (model.coupling.kind == Coupling::Kind::sheltered && driven_by_jet(source)) {
        compiled.scales.push_back(
            {Channel::speed, model.coupling.limit_speed, 2, 0, held.get(Channel::speed, 0.0), true});
    }
    std::size_t gap_axis = source.axes.size();
    bool others_held = true;
    std::vector<double> at(source.axes.size(), 0.0);
    for (std::size_t i = 0; i < source.axes.size(); ++i) {
        if (source.axes[i] == Channel::gap) {
            gap_axis = i;
        } else if (contains(varying, source.axes[i]) || source.axes[i] == Channel::heave_velocity) {
            others_held = false;
        } else {
            at[i] = held_value(source, i, seen, model);
        }
    }
    if (!others_held) {
        compiled.table.push_back(source.table);
        compiled.axes = source.axes;
    } else if (gap_axis < source.axes.size()) {
        compiled.curve = Curve::along(source.table, gap_axis, at);
    } else {
        const double flat = source.table.value(at.data());
        compiled.curve = Curve({-everywhere, everywhere}, {flat, flat}, {0, 0});
    }
    return compiled;
}

}  // namespace

GapRange lift_gap_range(const Model& model) {
    GapRange range;
    for (const ForceSource& source : model.forces) {
        for (std::size_t i = 0; i < source.axes.size(); ++i) {
            if (source.quantity == "lift_force" && source.axes[i] == Channel::gap) {
                range.lower = std::max(range.lower, source.table.axes()[i].lower);
                range.upper = std::min(range.upper, source.table.axes()[i].upper);
            }
        }
    }
    return range;
}

double contact_gap(const Model& model) {
    const double lower = lift_gap_range(model).lower;
    return !std::isnan(model.contact.gap) ? model.contact.gap : (lower < 0 && core::is_limit(lower) ? lower : 0.0);
}

double HeaveSource::Scale::factor(double value) const {
    return shelter ? shelter_factor(value, reference) : scale_factor(reference, exponent, dead_band, value);
}

HeavePlant::HeavePlant(const Model& declared, const Conditions& held, const std::vector<Channel>& varying)
    : varying_channels_(varying), held_(held.over(declared.conditions).over(references_of(declared))) {
    const Model model = declared.resolved();
    terms.mass = model.vehicle.mass + (model.vehicle.added_mass_heave_table ? 0 : model.vehicle.added_mass_heave);
    if (model.vehicle.added_mass_heave_table) {
        const double nothing[1] = {0};
        terms.added_mass = Curve::along(*model.vehicle.added_mass_heave_table, 0, nothing);
    }
    terms.constant = -model.vehicle.net_weight;
    terms.linear = model.drag_heave.linear;
    terms.quadratic = model.drag_heave.quadratic;
    if (model.drag_heave.kind == DragLaw::Kind::mixed) {
        terms.mixed = true;
        terms.mixed_law =
            MixedDrag(terms.linear, terms.quadratic, model.drag_heave.length, model.environment.kinematic_viscosity);
    }
    terms.restitution = model.contact.restitution;
    const GapRange range = lift_gap_range(model);
    terms.table_lower = range.lower;
    terms.table_upper = range.upper;
    terms.contact_gap = dynamics::contact_gap(model);
    Model acting = model;
    acting.effects = effects_on_tables(model, "lift_force");
    Conditions seen = held_;
    std::shared_ptr<const SourceShares> shares;
    if (!acting.effects.empty()) {
        seen_by_tables_ = std::make_shared<const StaticModel>(acting, "lift_force");
        seen = seen_by_tables_->seen(held_);
        shares = std::make_shared<const SourceShares>(acting, "lift_force");
    }
    for (const ForceSource& source : model.forces) {
        if (source.quantity == "lift_force") {
            HeaveSource compiled = compile(source, model, held_, seen, varying);
            compiled.shares = shares;
            compiled.share = terms.sources.size();
            compiled.held = held_;
            for (const Channel state : {Channel::gap, Channel::heave_velocity}) {  // shares are the same at all of them
                compiled.held[state] = held_.get(state, 0);
            }
            terms.sources.push_back(std::move(compiled));
        }
    }
    for (const EffectUse& use : model.effects) {
        effect(use.name).add_to(terms, use, model);
    }
    double slope = 0;
    if (!(inertia(std::max(terms.contact_gap, 0.0), slope) > 0) || !(inertia(1e3, slope) > 0)) {
        throw core::InputError("range", "virtual mass in heave is not positive", {model.name, {}, {}, {}},
                               "vehicle.mass + vehicle.added_mass_heave + effects must be positive at every gap");
    }
    refresh();
}

void HeavePlant::refresh() {
    folded_ = {};
    varying_.clear();
    needs_channels_ = keeps_channels_;
    for (std::size_t s = 0; s < terms.sources.size(); ++s) {
        const HeaveSource& source = terms.sources[s];
        bool varies = !source.table.empty();
        needs_channels_ = needs_channels_ || varies;
        for (const Channel channel : varying_channels_) {
            const bool scales = std::any_of(source.scales.begin(), source.scales.end(),
                                            [&](const HeaveSource::Scale& scale) { return scale.channel == channel; });
            varies = varies || scales || (source.shares && channel != Channel::input_force);
        }
        if (varies) {
            varying_.push_back(s);
        } else {
            folded_ = folded_.plus(1, source.curve, source.multiplier());
        }
    }
    for (const HeaveTerms::Correction& correction : terms.corrections) {
        needs_channels_ = needs_channels_ || correction.curve.empty();
    }
}

HeaveLoad HeavePlant::varying_lift(double h, double w, const Moment& moment) const {
    HeaveLoad sum;
    for (std::size_t k = 0; k < varying_.size(); ++k) {
        const HeaveSource& source = terms.sources[varying_[k]];
        const double factor = moment.factors ? moment.factors[k] : source.multiplier();
        if (source.table.empty()) {
            double slope = 0;
            sum.force += factor * source.curve.value(h, slope);
            sum.slope_h += factor * slope;
            continue;
        }
        double point[tables::max_axes] = {}, slope[tables::max_axes] = {};
        Conditions at = held_;
        if (moment.channels) {
            std::copy(moment.channels, moment.channels + channel_count, at.value.begin());
        }
        if (seen_by_tables_) {
            at = seen_by_tables_->seen(at);
        }
        at[Channel::gap] = h;
        at[Channel::heave_velocity] = w;
        for (std::size_t i = 0; i < source.axes.size(); ++i) {
            point[i] = at.get(source.axes[i], 0);  // a pitch that nobody gives
        }
        sum.force += factor * source.table[0].value(point, slope);
        for (std::size_t i = 0; i < source.axes.size(); ++i) {
            sum.slope_h += source.axes[i] == Channel::gap ? factor * slope[i] : 0;
            sum.slope_w += source.axes[i] == Channel::heave_velocity ? factor * slope[i] : 0;
        }
    }
    return sum;
}

HeaveLoad HeavePlant::table_lift(double h, double w, const Moment& moment) const {
    HeaveLoad sum;
    if (!folded_.empty()) {
        sum.force = folded_.value(h, sum.slope_h);
    }
    if (!varying_.empty()) {
        const HeaveLoad varying = varying_lift(h, w, moment);
        sum.force += varying.force;
        sum.slope_h += varying.slope_h;
        sum.slope_w += varying.slope_w;
    }
    roughen(terms, h, sum);
    return sum;
}

double HeavePlant::lift(double h, const Moment& moment, double w) const { return table_lift(h, w, moment).force; }

double HeavePlant::roughened(double sum, double h) const {
    HeaveLoad lift{sum, 0, 0};
    roughen(terms, h, lift);
    return lift.force;
}

double HeavePlant::static_force(double h, const Moment& moment) const {
    HeaveLoad load = table_lift(h, 0, moment);
    HeaveMoment felt = moment;
    felt.input = closed_input(h, 0, moment.input).force;
    add_given_forces(terms, h, 0, felt, held_, load);
    return load.force - resistance(h, 0.0);
}

double HeavePlant::water_drag(double relative) const {
    HeaveLoad load;
    add_water_drag<false>(terms, relative + terms.current, load);
    return -load.force;
}

double HeavePlant::resistance(double h, double w) const {
    HeaveLoad load;
    add_water_drag<false>(terms, w, load);
    add_guided_resistance<false>(terms, h, w, 0, load);
    return -load.force;
}

double HeavePlant::damping(double h) const {
    constexpr double speed = 1e-7;  // m/s
    HeaveLoad up, down;
    for (const auto& [w, load] : {std::pair{speed, &up}, std::pair{-speed, &down}}) {
        add_water_drag<false>(terms, w, *load);
        add_guided_resistance<false>(terms, h, w, 0, *load);
        add_corrections(terms, h, w, {}, held_, *load);  // over gap and velocity at once
        add_extras(terms, 0, h, w, *load);
        load->force += table_lift(h, w).force;
    }
    const double friction = 2 * terms.friction * speed / std::hypot(speed, terms.friction_width);
    return (down.force - up.force - friction) / (2 * speed);
}

core::Problems HeavePlant::left_out_of_small_motions() const {
    if (terms.friction == 0) {
        return {};
    }
    const std::string force = core::format_number(1e3 * terms.friction, 4) + " mN";
    return {{core::Problem::Severity::warning,
             "Coulomb friction of " + force +
                 " has no slope at rest and is left out of modes, damping and gains: they are of motions without it, "
                 "and near rest it holds the body wherever the other forces balance within " +
                 force,
             {}}};
}

double HeavePlant::timed_force(double t) const { return dynamics::timed_force(terms, t); }

double HeavePlant::other_force(double h, double w, const Moment& moment, const double* memory) const {
    HeaveLoad load;
    add_given_forces(terms, h, w, moment, held_, load);
    add_guided_resistance<false>(terms, h, w, 0, load);
    return load.force + heave_memory(terms, w, memory).force;
}

double HeavePlant::inertia(double h, double& slope) const {
    const HeaveInertia all = heave_inertia(terms, h);
    slope = all.slope;
    return all.mass;
}

template <bool Slopes>
double HeavePlant::evaluate(double h, double w, const Moment& moment, const double* memory, HeaveSlopes& slopes) const {
    HeaveLoad load;
    if (!Slopes && varying_.empty()) {
        load.force = folded_.empty() ? 0.0 : folded_(h);
        roughen(terms, h, load);
    } else {
        load = table_lift(h, w, moment);
    }
    if (loop && !loop_has_states()) {
        HeaveMoment felt = moment;
        const HeaveLoad input = closed_input(h, w, moment.input);
        felt.input = input.force;
        load.slope_h += input.slope_h;
        load.slope_w += input.slope_w;
        add_forces<Slopes>(terms, h, w, felt, held_, load);
    } else {
        add_forces<Slopes>(terms, h, w, moment, held_, load);
    }
    return heave_acceleration<Slopes>(terms, h, w, load, heave_memory(terms, w, memory), slopes);
}

double HeavePlant::acceleration(double h, double w, const Moment& moment, const double* memory) const {
    HeaveSlopes unused;
    return evaluate<false>(h, w, moment, memory, unused);
}

double HeavePlant::acceleration(double h, double w, const Moment& moment, const double* memory,
                                HeaveSlopes& slopes) const {
    return evaluate<true>(h, w, moment, memory, slopes);
}

HeaveLoad HeavePlant::closed_input(double h, double w, double given) const {
    if (!loop) {
        return {given, 0, 0};
    }
    const double asked = loop->command(h, w), command = given + asked;
    const bool held_by_limit = loop->limit > 0 && std::abs(asked) >= loop->limit;
    const bool dead = std::abs(command) <= terms.actuator.dead_zone && terms.actuator.dead_zone > 0;
    const double follows = held_by_limit || dead ? 0 : terms.actuator.gain * (1 - terms.thrust_lost(h));
    return {terms.actuator.felt(command), -follows * loop->gap_gain, -follows * loop->velocity_gain};
}

bool HeavePlant::autonomous() const {
    const bool corrections_over_time =
        std::any_of(terms.corrections.begin(), terms.corrections.end(),
                    [](const HeaveTerms::Correction& correction) { return contains(correction.axes, Channel::time); });
    return !terms.forced_in_time() && terms.extras.empty() && terms.history == 0 && !corrections_over_time &&
           !loop_has_states();
}

const HistoryKernel& history_kernel() {
    // 1/sqrt(t) = 1/sqrt(pi) * integral of s^-1/2 exp(-s t) ds; with s = exp(x) the trapezium rule in x converges
    // exponentially: spacing ln 4 leaves 0.25 %.
    static const HistoryKernel kernel = [] {
        HistoryKernel k{};
        const double spacing = std::log(4.0);
        const double root_pi = std::sqrt(std::numbers::pi);
        constexpr double slowest_rate = 0.003;  // 1/s
        double rate = slowest_rate / 16;
        for (std::size_t i = 0; i < history_states; ++i, rate *= 4) {
            k.rate[i] = rate;
            k.weight[i] = spacing * std::sqrt(rate) / root_pi;
        }
        k.weight[0] *= 2;  // stands for all that is slower: a geometric sum
        k.mass = 0;
        for (int i = 0; i < 60; ++i, rate *= 4) {
            k.mass += spacing / std::sqrt(rate) / root_pi;
        }
        return k;
    }();
    return kernel;
}

/// Gaps where a body may rest: of the tables, from contact on.
std::pair<double, double> resting_range(const HeavePlant& plant) {
    const Curve& curve = plant.lift_curve();
    double lower =
        std::max(plant.terms.contact_gap, core::is_limit(plant.terms.table_lower) ? plant.terms.table_lower : 0.0);
    double upper = core::is_limit(plant.terms.table_upper) ? plant.terms.table_upper : lower + 10;
    // Tables that end at different gaps: one that has ended holds its value, and the body may well rest there.
    if (core::is_limit(plant.terms.table_upper) && !curve.empty() && curve.lower() > -everywhere / 10 &&
        curve.upper() < everywhere / 10) {
        lower = std::max(plant.terms.contact_gap, std::min(lower, curve.lower()));
        upper = std::max(upper, curve.upper());
    }
    return {lower, upper};
}

std::vector<double> bracketing_gaps(const HeavePlant& plant) {
    const auto [lower, upper] = resting_range(plant);
    constexpr int cells = 2000;
    std::vector<double> grid = plant.lift_curve().empty() ? std::vector<double>{} : plant.lift_curve().knots();
    for (int i = 0; i < cells; ++i) {
        grid.push_back(lower + (upper - lower) * i / cells);
    }
    grid.push_back(upper);
    std::sort(grid.begin(), grid.end());
    std::erase_if(grid, [low = lower, high = upper](double h) { return h < low || h > high; });
    grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
    return grid;
}

namespace {

/// `step`: over which slopes are taken; `stable` and `unstable` count the names.
HeaveEquilibrium equilibrium_at(const HeavePlant& plant, double gap, double step, int& stable, int& unstable) {
    HeaveEquilibrium e;
    e.gap = gap;
    e.stiffness = -(plant.static_force(e.gap + step) - plant.static_force(e.gap - step)) / (2 * step);
    e.stable = e.stiffness > 0;
    double slope = 0;
    const double mass = plant.inertia(e.gap, slope);
    const double damping = plant.damping(e.gap);
    if (e.stable) {
        e.frequency = std::sqrt(e.stiffness / mass);
        e.damping_ratio = damping / (2 * std::sqrt(e.stiffness * mass));
        e.name = stable < 26 ? std::string(1, static_cast<char>('A' + stable)) : "A" + std::to_string(stable);
        ++stable;
    } else {
        const double half = damping / (2 * mass);
        e.growth = -half + std::sqrt(half * half - e.stiffness / mass);
        e.name = "U" + std::to_string(++unstable);
    }
    return e;
}

}  // namespace

std::vector<HeaveEquilibrium> heave_equilibria(const HeavePlant& plant) {
    const std::vector<double> grid = bracketing_gaps(plant);
    std::vector<HeaveEquilibrium> found;
    int stable = 0, unstable = 0;
    for (std::size_t i = 0; i + 1 < grid.size(); ++i) {
        double lo = grid[i], hi = grid[i + 1];
        const double flo = plant.static_force(lo), fhi = plant.static_force(hi);
        // A zero on the grid belongs to the interval on its left; stretches without force are no equilibria.
        const bool crosses = flo != 0 && (fhi == 0 || (flo > 0) != (fhi > 0));
        if (!crosses && !(i == 0 && flo == 0 && fhi != 0)) {
            continue;
        }
        if (flo == 0) {
            hi = lo;
        } else if (fhi == 0) {
            lo = hi;
        }
        for (int step = 0; step < 100 && hi > lo; ++step) {
            const double middle = (lo + hi) / 2;
            if (middle == lo || middle == hi) {
                break;
            }
            ((plant.static_force(middle) > 0) == (flo > 0) ? lo : hi) = middle;
        }
        found.push_back(equilibrium_at(plant, (lo + hi) / 2, 1e-6 * (grid.back() - grid.front()), stable, unstable));
    }
    return found;
}

}  // namespace underbody::dynamics
