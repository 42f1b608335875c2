#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "surrogates/dynamics/contact_gap.h"
#include "surrogates/dynamics/drag.h"
#include "surrogates/dynamics/force_sources.h"
#include "surrogates/dynamics/heave.h"

namespace underbody::dynamics {

namespace {

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

HeaveSource compile(const ForceSource& source, const Model& model, const Conditions& held,
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
            at[i] = held_value(source, i, held, model);
        }
    }
    if (!others_held) {
        compiled.table.push_back(source.table);
        compiled.axes = source.axes;
    } else if (gap_axis < source.axes.size()) {
        compiled.curve = Curve::along(source.table, gap_axis, at);
    } else {
        const double flat = source.table.value(at.data());
        compiled.curve = Curve({-1e6, 1e6}, {flat, flat}, {0, 0});
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
    return !std::isnan(model.contact.gap) ? model.contact.gap : (lower < 0 && lower > -1e299 ? lower : 0.0);
}

double HeaveSource::Scale::factor(double value) const {
    return shelter ? shelter_factor(value, reference) : scale_factor(reference, exponent, dead_band, value);
}

HeavePlant::HeavePlant(const Model& declared, const Conditions& held, const std::vector<Channel>& varying)
    : varying_channels_(varying), held_(held.over(declared.conditions)) {
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
    for (const ForceSource& source : model.forces) {
        if (source.quantity == "lift_force") {
            terms.sources.push_back(compile(source, model, held_, varying));
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
    gap_correction_ = velocity_correction_ = {};
    varying_.clear();
    table_corrections_.clear();
    needs_channels_ = keeps_channels_;
    for (std::size_t s = 0; s < terms.sources.size(); ++s) {
        const HeaveSource& source = terms.sources[s];
        bool varies = !source.table.empty();
        needs_channels_ = needs_channels_ || varies;
        double factor = source.factor;
        for (const HeaveSource::Scale& scale : source.scales) {
            varies = varies || contains(varying_channels_, scale.channel);
            factor *= scale.factor(scale.held);
        }
        if (varies) {
            varying_.push_back(s);
        } else {
            folded_ = folded_.plus(1, source.curve, factor);
        }
    }
    const double nothing[1] = {0};
    for (std::size_t i = 0; i < terms.corrections.size(); ++i) {
        const HeaveTerms::Correction& correction = terms.corrections[i];
        if (correction.axes.size() == 1 && correction.axes[0] == Channel::gap) {
            gap_correction_ = gap_correction_.plus(1, Curve::along(correction.table, 0, nothing), 1);
        } else if (correction.axes.size() == 1 && correction.axes[0] == Channel::heave_velocity) {
            velocity_correction_ = velocity_correction_.plus(1, Curve::along(correction.table, 0, nothing), 1);
        } else {
            table_corrections_.push_back(i);
            needs_channels_ = true;
        }
    }
}

double HeavePlant::varying_lift(double h, const Moment& moment) const {
    double sum = 0;
    for (std::size_t k = 0; k < varying_.size(); ++k) {
        const HeaveSource& source = terms.sources[varying_[k]];
        double factor = 0;
        if (moment.factors) {
            factor = moment.factors[k];
        } else {
            factor = source.factor;
            for (const HeaveSource::Scale& scale : source.scales) {
                factor *= scale.factor(scale.held);
            }
        }
        if (source.table.empty()) {
            sum += factor * source.curve(h);
            continue;
        }
        double point[tables::max_axes] = {};
        for (std::size_t i = 0; i < source.axes.size(); ++i) {
            const auto index = static_cast<std::size_t>(source.axes[i]);
            point[i] = source.axes[i] == Channel::gap ? h
                       : moment.channels              ? moment.channels[index]
                                                      : held_.value[index];
        }
        sum += factor * source.table[0].value(point);
    }
    return sum;
}

double HeavePlant::lift(double h, const Moment& moment) const {
    double sum = folded_.empty() ? 0.0 : folded_(h);
    if (!varying_.empty()) {
        sum += varying_lift(h, moment);
    }
    return roughened(sum, h);
}

double HeavePlant::table_corrections(double h, double w, const Moment& moment) const {
    double sum = 0;
    for (const std::size_t i : table_corrections_) {
        const HeaveTerms::Correction& correction = terms.corrections[i];
        double point[tables::max_axes] = {};
        for (std::size_t a = 0; a < correction.axes.size(); ++a) {
            const Channel channel = correction.axes[a];
            const auto index = static_cast<std::size_t>(channel);
            const double outside = moment.channels ? moment.channels[index] : held_.value[index];
            point[a] = channel == Channel::gap              ? h
                       : channel == Channel::heave_velocity ? w
                       : channel == Channel::time           ? moment.t
                       : channel == Channel::input_force    ? moment.input
                                                            : (std::isnan(outside) ? 0.0 : outside);
        }
        sum += correction.table.value(point);
    }
    return sum;
}

double HeavePlant::roughened(double sum, double h) const {
    if (terms.rough_near != 0 || terms.rough_far != 0) {
        const double x = h / terms.rough_length;
        sum *= 1 + (terms.rough_near - terms.rough_far * x * x) / (1 + x * x);
    }
    return sum;
}

double HeavePlant::static_force(double h, const Moment& moment) const {
    double force = terms.constant + moment.input + lift(h, moment) - terms.stiffness * (h - terms.stiffness_gap) -
                   resistance(h, 0.0);
    if (!gap_correction_.empty()) {
        force += gap_correction_(h);
    }
    if (!table_corrections_.empty()) {
        force += table_corrections(h, 0, moment);
    }
    for (const HeaveTerms::ExtraTerm& extra : terms.extras) {
        force += extra.force(extra.parameters, moment.t, h, 0);
    }
    return force;
}

double HeavePlant::water_drag(double relative) const {
    const double size = std::abs(relative);
    const double force = terms.mixed ? terms.mixed_law(relative) : (terms.linear + terms.quadratic * size) * relative;
    return force + (terms.extra_linear + terms.extra_quadratic * size) * relative;
}

double HeavePlant::guided_resistance(double h, double w) const {
    double force = 0;
    if (terms.friction != 0) {
        force += terms.friction * w / std::sqrt(w * w + terms.friction_width * terms.friction_width);
    }
    if (terms.film != 0) {
        const double gap = std::max(h, 1e-5);
        force += terms.film * w / (gap * gap * gap);
    }
    if (!velocity_correction_.empty()) {
        force -= velocity_correction_(w);
    }
    return force;
}

double HeavePlant::resistance(double h, double w) const {
    return water_drag(w - terms.current) + guided_resistance(h, w);
}

double HeavePlant::wave_force(double t) const {
    double force = 0;
    for (const HeaveTerms::Wave& wave : terms.waves) {
        force += wave.amplitude * std::sin(6.283185307179586 * wave.frequency * t + wave.phase);
    }
    return force;
}

double HeavePlant::other_force(double h, double w, const Moment& moment, const double* memory) const {
    double force = terms.constant + moment.input - terms.stiffness * (h - terms.stiffness_gap) - guided_resistance(h, w);
    if (!gap_correction_.empty()) {
        force += gap_correction_(h);
    }
    if (!table_corrections_.empty()) {
        force += table_corrections(h, w, moment);
    }
    for (const HeaveTerms::ExtraTerm& extra : terms.extras) {
        force += extra.force(extra.parameters, moment.t, h, w);
    }
    if (terms.history != 0 && memory) {
        const HistoryKernel& kernel = history_kernel();
        double sum = 0;
        for (std::size_t i = 0; i < history_states; ++i) {
            sum += kernel.weight[i] * (w + memory[i]);
        }
        force -= terms.history * sum;
    }
    return force;
}

double HeavePlant::inertia(double h, double& slope) const {
    double mass = terms.mass;
    slope = 0;
    if (!terms.added_mass.empty()) {
        double s = 0;
        mass += terms.added_mass.value(h, s);
        slope += s;
    }
    for (const HeaveTerms::Growth& growth : terms.growth) {
        const double base = std::max(h, 0.0) + growth.length;
        mass += growth.mass * growth.length / base;
        slope -= h > 0 ? growth.mass * growth.length / (base * base) : 0.0;
    }
    return mass;
}

double HeavePlant::acceleration(double h, double w, const Moment& moment, const double* memory) const {
    double force =
        other_force(h, w, moment, memory) + wave_force(moment.t) + lift(h, moment) - water_drag(w - terms.current);
    double mass = terms.mass;
    if (!terms.growth.empty() || !terms.added_mass.empty()) {
        double slope = 0;
        mass = inertia(h, slope);
        force -= 0.5 * slope * w * w;
    }
    if (memory) {
        mass += history_mass();
    }
    return force / mass;
}

bool HeavePlant::autonomous() const {
    const bool corrections_over_time =
        std::any_of(table_corrections_.begin(), table_corrections_.end(),
                    [this](std::size_t i) { return contains(terms.corrections[i].axes, Channel::time); });
    return terms.waves.empty() && terms.extras.empty() && terms.history == 0 && !corrections_over_time;
}

const HistoryKernel& history_kernel() {
    // 1/sqrt(t) = 1/sqrt(pi) * integral of s^-1/2 exp(-s t) ds; with s = exp(x) the trapezium rule in x converges
    // exponentially: spacing ln 4 leaves 0.25 %.
    static const HistoryKernel kernel = [] {
        HistoryKernel k{};
        const double spacing = std::log(4.0);
        const double root_pi = std::sqrt(3.14159265358979323846);
        double rate = 0.003 / 16;
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

std::vector<HeaveEquilibrium> heave_equilibria(const HeavePlant& plant) {
    const Curve& curve = plant.lift_curve();
    double lower = std::max(plant.terms.contact_gap, plant.terms.table_lower > -1e299 ? plant.terms.table_lower : 0.0);
    double upper = plant.terms.table_upper < 1e299 ? plant.terms.table_upper : lower + 10;
    // Tables that end at different gaps: one that has ended holds its value, and the body may well rest there.
    if (plant.terms.table_upper < 1e299 && !curve.empty() && curve.lower() > -1e5 && curve.upper() < 1e5) {
        lower = std::max(plant.terms.contact_gap, std::min(lower, curve.lower()));
        upper = std::max(upper, curve.upper());
    }
    // Knots and points between them bracket every sign change of the static force that a table can make.
    std::vector<double> grid;
    if (!curve.empty()) {
        for (const double knot : curve.knots()) {
            grid.push_back(knot);
        }
    }
    for (int i = 0; i <= 2000; ++i) {
        grid.push_back(lower + (upper - lower) * i / 2000.0);
    }
    std::sort(grid.begin(), grid.end());
    grid.erase(std::remove_if(grid.begin(), grid.end(), [&](double h) { return h < lower || h > upper; }), grid.end());
    grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
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
        HeaveEquilibrium e;
        e.gap = (lo + hi) / 2;
        const double step = 1e-6 * (upper - lower);
        e.stiffness = -(plant.static_force(e.gap + step) - plant.static_force(e.gap - step)) / (2 * step);
        e.stable = e.stiffness > 0;
        double slope = 0;
        const double mass = plant.inertia(e.gap, slope);
        const double speed = 1e-7;
        const double damping = (plant.resistance(e.gap, speed) - plant.resistance(e.gap, -speed)) / (2 * speed);
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
        found.push_back(e);
    }
    return found;
}

}  // namespace underbody::dynamics
