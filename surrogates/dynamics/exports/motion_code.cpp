#include "surrogates/dynamics/exports/motion_code.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/no_limit.h"
#include "core/text.h"
#include "surrogates/dynamics/model/drag.h"
#include "surrogates/dynamics/model/force_sources.h"
#include "surrogates/dynamics/model/force_tables.h"
#include "surrogates/dynamics/model/source_shares.h"
#include "surrogates/tables/exports/hermite.h"

namespace underbody::dynamics {

namespace {

constexpr double body_step = 0.1;                           ///< s, at most
constexpr double nominal_body = 0.1, nominal_heave = 0.01;  ///< size of the states

std::string number(double value) {
    if (std::isnan(value)) {
        return "NAN";
    }
    if (std::isinf(value)) {
        return value > 0 ? "1e300" : "-1e300";  // core::no_limit
    }
    const std::string text = core::format_number(value);
    return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

template <class List>
std::string listed(const List& values) {
    std::string text = "{";
    for (const double value : values) {
        text += (text.size() > 1 ? "," : "") + number(value);
        if (text.size() - std::min(text.size(), text.rfind('\n') + 1) > 110) {
            text += "\n";
        }
    }
    return text + "}";
}

std::string count(std::size_t value) { return std::to_string(value); }
std::string index_of(Channel channel) { return count(static_cast<std::size_t>(channel)); }

/// A force of the motion: C's `source`s.
struct CodeSource {
    std::string grid;  ///< its name in C
    double factor = 1;
    std::vector<int> channels;  ///< of its axes; -1: held
    std::vector<double> held;
    std::vector<HeaveSource::Scale> scales;
};

class Code {
public:
    explicit Code(const MotionSource& of) : of_(of) {}

    std::string text() {
        sizes();
        std::string head = take();
        tables();
        vertical();
        motion();
        const std::string data = take();
        std::string all =
            "/* " + of_.fmu.states.front().name + " and what follows: a motion written by Underbody. */\n";
        all += c_part("numbers.c") + head + c_part("tables.c") + c_part("vertical.c") + data + c_part("moment.c");
        if (of_.motion == FmuMotion::heave) {
            return all + c_part("heave.c") + c_part("delay.c") + c_part("fmi2.c") + c_part("co_simulation.c");
        }
        return all +
               (of_.motion == FmuMotion::body
                    ? c_part("body.c") + c_part("body_rates.c") + c_part("contact.c") + c_part("body_outputs.c")
                    : c_part("heave_pitch.c") + c_part("contact.c") + c_part("heave_pitch_rates.c")) +
               c_part("delay.c") + c_part("fmi2.c") + c_part("co_simulation.c");
    }

private:
    std::string take() {
        std::string text;
        std::swap(text, out_);
        return text;
    }
    void define(const std::string& name, const std::string& value) { out_ += "#define " + name + " " + value + "\n"; }
    void constant(const std::string& name, double value) {
        out_ += "static const double " + name + " = " + number(value) + ";\n";
    }

    void sizes() {
        const HeaveTerms& terms = of_.vertical.terms;
        for (std::size_t c = 0; c < channel_count; ++c) {
            std::string name = channel_name(static_cast<Channel>(c));
            std::transform(name.begin(), name.end(), name.begin(), [](unsigned char l) { return std::toupper(l); });
            define("CHANNEL_" + name, count(c));
        }
        define("CHANNELS", count(channel_count));
        const std::size_t states = of_.fmu.states.size(), memories = terms.history != 0 ? history_states : 0;
        define("STATES", count(states));
        define("INPUTS", count(of_.fmu.inputs.size()));
        define("GIVEN_STATES", count(of_.fmu.start_states));
        define("MEMORY_AT", count(states - memories));
        define("LAG_AT", count(states - memories - (terms.actuator.lag > 0 ? 1 : 0)));
        define("JETS", count(jets()));
        define("DELAY", number(terms.actuator.delay));
        define("DELAYED", terms.actuator.delay > 0 ? "1" : "0");
        double longest = of_.motion == FmuMotion::body ? body_step : 0;
        for (const HeaveTerms::Wave& wave : terms.waves) {
            const double part = 0.1 / std::max(wave.frequency, 1e-9);
            longest = longest > 0 ? std::min(longest, part) : part;
        }
        define("MAX_STEP", number(longest));
        // On the ground nothing moves, so that no error shows where the force may lift the body again.
        define("MAX_STEP_AT_REST", of_.motion == FmuMotion::heave ? "0.01" : number(longest));
        define("ABSOLUTE", of_.motion == FmuMotion::body ? "1e-2" : "1e-3");
    }
    [[nodiscard]] std::size_t jets() const { return of_.motion == FmuMotion::body ? of_.model.jets.size() : 0; }

    std::string grid(const std::vector<std::vector<double>>& points, const std::vector<double>& nodes) {
        const std::string id = count(grids_++);
        std::string sizes, names;
        for (std::size_t k = 0; k < points.size(); ++k) {
            out_ += "static const double grid_" + id + "_x" + count(k) + "[] = " + listed(points[k]) + ";\n";
            sizes += (k == 0 ? "" : ", ") + count(points[k].size());
            names += (k == 0 ? "" : ", ") + ("grid_" + id + "_x" + count(k));
        }
        out_ += "static const double grid_" + id + "_nodes[] = " + listed(nodes) + ";\n";
        out_ += "static const grid grid_" + id + " = {" + count(points.size()) + ", {" + sizes + "}, {" + names +
                "}, grid_" + id + "_nodes};\n";
        return "grid_" + id;
    }
    std::string grid(const tables::ForceTable& table) {
        const tables::CubicGrid& surface = tables::surface_of(table);
        return grid(surface.points(), surface.hermite());
    }
    std::string grid(const Curve& curve) {
        std::vector<double> nodes;
        for (const double x : curve.knots()) {
            double slope = 0;
            const double value = curve.value(x, slope);
            nodes.push_back(value);
            nodes.push_back(slope);
        }
        return grid({curve.knots()}, nodes);
    }

    /// An axis that nothing moves, and a correction's or a table's own.
    void axis(CodeSource& source, Channel channel, bool always = false) {
        source.channels.push_back(always || of_.moves(channel) ? static_cast<int>(channel) : -1);
        source.held.push_back(of_.held.get(channel, 0));
    }

    void write(const std::string& name, const std::vector<CodeSource>& sources) {
        std::string list;
        for (std::size_t i = 0; i < sources.size(); ++i) {
            const CodeSource& one = sources[i];
            const std::string scales = name + "_scales_" + count(i);
            if (!one.scales.empty()) {
                out_ += "static const scale " + scales + "[] = {";
                for (const HeaveSource::Scale& scale : one.scales) {
                    out_ += "{" + index_of(scale.channel) + ", " + (scale.shelter ? "1" : "0") + ", " +
                            number(scale.reference) + ", " + number(scale.exponent) + ", " + number(scale.dead_band) +
                            "}, ";
                }
                out_ += "};\n";
            }
            std::string channels;
            for (std::size_t k = 0; k < one.channels.size(); ++k) {
                channels += (k == 0 ? "" : ", ") + std::to_string(one.channels[k]);
            }
            list += "    {&" + one.grid + ", " + number(one.factor) + ", {" + channels + "}, " + listed(one.held) +
                    ", " + count(one.scales.size()) + ", " + (one.scales.empty() ? "NULL" : scales) + "},\n";
        }
        if (!sources.empty()) {
            out_ += "static const source " + name + "_sources[] = {\n" + list + "};\n";
        }
    }
    void force(const std::string& name, const std::vector<CodeSource>& sources) {
        write(name, sources);
        out_ += "static const force " + name + " = {" + count(sources.size()) + ", " +
                (sources.empty() ? "NULL" : name + "_sources") + "};\n";
    }

    /// In heave: the sources as the plant has compiled them.
    std::vector<CodeSource> lift_in_heave() {
        std::vector<CodeSource> all;
        for (const HeaveSource& source : of_.vertical.terms.sources) {
            CodeSource one;
            if (source.shares) {
                one.factor = source.multiplier();
            } else {
                one.factor = source.factor;
                one.scales = source.scales;
            }
            if (source.table.empty()) {
                one.grid = grid(source.curve);
                axis(one, Channel::gap, true);
            } else {
                one.grid = grid(source.table[0]);
                for (const Channel channel : source.axes) {
                    axis(one, channel);
                }
            }
            all.push_back(std::move(one));
        }
        return all;
    }

    /// In motions with pitch: the tables of a quantity themselves; where effects of the model change them, what comes
    /// of it as one table.
    std::vector<CodeSource> sources_of(const std::string& quantity) {
        std::vector<CodeSource> all;
        Model acting = of_.model;
        acting.effects = effects_on_tables(of_.model, quantity);
        if (!acting.effects.empty()) {
            return sampled(acting, quantity);
        }
        for (const ForceSource& source : of_.model.forces) {
            if (source.quantity != quantity) {
                continue;
            }
            CodeSource one;
            one.grid = grid(source.table);
            one.factor = source.factor;
            for (const Channel channel : source.axes) {
                axis(one, channel);
            }
            for (const ForceScale& scale : source.scales) {
                one.scales.push_back({scale.channel, scale.reference, scale.exponent, scale.dead_band, 0, false});
            }
            if (of_.model.coupling.kind == Coupling::Kind::sheltered && driven_by_jet(source)) {
                one.scales.push_back({Channel::speed, of_.model.coupling.limit_speed, 2, 0, 0, true});
            }
            all.push_back(std::move(one));
        }
        return all;
    }

    std::vector<CodeSource> sampled(const Model& acting, const std::string& quantity) {
        const auto of_it = [&](const auto& one) { return one.quantity == quantity; };
        if (std::none_of(acting.forces.begin(), acting.forces.end(), of_it)) {
            if (std::any_of(acting.effects.begin(), acting.effects.end(), of_it)) {
                throw core::InputError("effect",
                                       "an effect gives a " + quantity +
                                           " that no force table has: this motion "
                                           "cannot be written as an FMU",
                                       {of_.model.name, {}, {}, {}});
            }
            return {};
        }
        ForceTablesOptions options;
        options.quantities = {quantity};
        options.held = of_.held;
        for (std::size_t c = 0; c < channel_count; ++c) {
            const auto channel = static_cast<Channel>(c);
            const bool used = std::any_of(acting.forces.begin(), acting.forces.end(), [&](const ForceSource& source) {
                const auto is = [&](const auto& one) { return one == channel; };
                return source.quantity == quantity &&
                       (std::any_of(source.axes.begin(), source.axes.end(), is) ||
                        std::any_of(source.scales.begin(), source.scales.end(),
                                    [&](const ForceScale& scale) { return scale.channel == channel; }));
            });
            if (used && of_.moves(channel)) {
                options.held[channel] = std::nan("");
                options.axes.push_back({channel_name(channel), {}, {}});
            }
        }
        const ForceTables tables = force_tables(acting, options);
        CodeSource one;
        one.grid = grid(tables.tables.front());
        for (const tables::TableAxis& along : tables.tables.front().axes()) {
            Channel channel{};
            find_channel(along.name, channel);
            axis(one, channel);
        }
        std::string names;
        for (const EffectUse& use : acting.effects) {
            names += (names.empty() ? "" : ", ") + use.name;
        }
        of_.fmu.remarks.push_back(
            {core::Problem::Severity::warning,
             quantity + " with " + names + " was sampled into a table, which differs from the model by at most " +
                 core::format_number(tables.tables.front().sampling_error(), 3) + " " + tables.tables.front().unit(),
             {}});
        return {one};
    }

    void tables() {
        // Types stand in parts of C before these.
        if (of_.motion == FmuMotion::heave) {
            force("lift", lift_in_heave());
            return;
        }
        force("lift", sources_of("lift_force"));
        force("pitch_moment", sources_of("pitch_moment"));
        const bool runs = of_.motion == FmuMotion::body || of_.held.get(Channel::speed, 0) != 0;
        force("drag", runs ? sources_of("drag_force") : std::vector<CodeSource>{});
        if (of_.motion == FmuMotion::body) {
            force("side", sources_of("side_force"));
            force("roll_moment", sources_of("roll_moment"));
            force("yaw_moment", sources_of("yaw_moment"));
        }
    }

    void law(const std::string& field, double linear, double quadratic, const MixedDrag* mixed) {
        out_ += field + "{" + number(linear) + ", " + number(quadratic) + ", " + (mixed != nullptr ? "1" : "0") + ", " +
                number(mixed != nullptr ? mixed->w1 : 0) + ", " + number(mixed != nullptr ? mixed->w2 : 0) + ", " +
                (mixed != nullptr ? listed(mixed->c) : "{0.0}") + "}";
    }
    void law(const std::string& name, const DragLaw& of) {
        const MixedDrag mixed(of.linear, of.quadratic, of.length, of_.model.environment.kinematic_viscosity);
        law("static const drag_law " + name + " = ", of.linear, of.quadratic,
            of.kind == DragLaw::Kind::mixed ? &mixed : nullptr);
        out_ += ";\n";
    }

    void vertical() {
        const HeaveTerms& t = of_.vertical.terms;
        const std::string added = t.added_mass.empty() ? "NULL" : "&" + grid(t.added_mass);
        std::vector<double> growth, wave;
        for (const HeaveTerms::Growth& one : t.growth) {
            growth.insert(growth.end(), {one.mass, one.length});
        }
        for (const HeaveTerms::Wave& one : t.waves) {
            wave.insert(wave.end(), {one.amplitude, one.frequency, one.phase});
        }
        std::vector<CodeSource> corrections;
        for (const HeaveTerms::Correction& one : t.corrections) {
            CodeSource source;
            source.grid = grid(one.table);
            for (const Channel channel : one.axes) {
                axis(source, channel, true);
            }
            corrections.push_back(std::move(source));
        }
        write("correction", corrections);
        out_ += "static const double growth[] = " + listed(growth.empty() ? std::vector<double>{0} : growth) +
                ";\nstatic const double wave[] = " + listed(wave.empty() ? std::vector<double>{0} : wave) + ";\n";
        out_ += "static const vertical_terms terms = {" + number(t.mass) + ", " + number(t.constant) + ", " +
                number(t.growth_of_force) + ", " + added + ", " + count(t.growth.size()) + ", " +
                count(t.waves.size()) + ", " + count(corrections.size()) + ", growth, wave, " +
                (corrections.empty() ? "NULL" : "correction_sources") + ",\n    ";
        law("", t.linear, t.quadratic, t.mixed ? &t.mixed_law : nullptr);
        for (const double value : {t.current,        t.extra_linear,  t.extra_quadratic, t.friction,
                                   t.friction_width, t.film,          t.stiffness,       t.stiffness_gap,
                                   t.rough_near,     t.rough_far,     t.rough_length,    t.rough_sharpness,
                                   t.thrust_loss,    t.thrust_length, t.history,         t.actuator.dead_zone,
                                   t.actuator.gain,  t.actuator.lag,  t.contact_gap,     t.restitution}) {
            out_ += ", " + number(value);
        }
        const HistoryKernel& kernel = history_kernel();
        out_ += "};\nstatic const history_kernel kernel = {" + listed(kernel.rate) + ", " + listed(kernel.weight) +
                ", " + number(kernel.mass) + "};\n";
    }

    void motion() {
        std::vector<double> starts, inputs;
        std::string channels;
        for (const MotionFmuVariable& state : of_.fmu.states) {
            starts.push_back(state.start);
        }
        for (const MotionFmuVariable& input : of_.fmu.inputs) {
            inputs.push_back(input.start);
            Channel channel{};
            const bool known = find_channel(input.name, channel);
            channels += (channels.empty() ? "" : ", ") + (known ? index_of(channel) : std::string("-1"));
        }
        out_ += "static const double start_states[] = " + listed(starts) +
                ";\nstatic const double start_inputs[] = " + listed(inputs) +
                ";\nstatic const int channel_of_input[] = {" + channels +
                "};\nstatic const double held_channels[] = " + listed(of_.held.value) + ";\n";
        out_ +=
            "static const double nominal_states[] = " +
            listed(std::vector<double>(starts.size(), of_.motion == FmuMotion::body ? nominal_body : nominal_heave)) +
            ";\n";
        ranges();
        jet_list();
        if (of_.motion != FmuMotion::heave) {
            body();
        }
    }

    void ranges() {
        std::string list;
        std::size_t many = 0;
        for (std::size_t c = 0; c < channel_count; ++c) {
            const auto channel = static_cast<Channel>(c);
            double lower = -core::no_limit, upper = core::no_limit;
            for (const ForceSource& source : of_.model.forces) {
                for (std::size_t k = 0; k < source.axes.size(); ++k) {
                    const bool seen = of_.motion != FmuMotion::heave || source.quantity == "lift_force";
                    if (seen && source.axes[k] == channel && of_.moves(channel)) {
                        lower = std::max(lower, source.table.axes()[k].lower);
                        upper = std::min(upper, source.table.axes()[k].upper);
                    }
                }
            }
            if (core::is_limit(lower) || core::is_limit(upper)) {
                const bool size = of_.motion == FmuMotion::body && channel == Channel::speed;
                list +=
                    "{" + count(c) + ", " + (size ? "1" : "0") + ", " + number(lower) + ", " + number(upper) + "}, ";
                ++many;
            }
        }
        define("RANGES", count(many));
        out_ += "static const struct {\n    int channel, magnitude;\n    double lower, upper;\n} ranges[] = {" +
                (many == 0 ? "{0, 0, 0.0, 0.0}" : list) + "};\n";
    }

    void jet_list() {
        std::string list;
        std::size_t state = of_.fmu.start_states;
        for (std::size_t i = 0; i < jets(); ++i) {
            const Jet& jet = of_.model.jets[i];
            list += "    {" + listed(jet.position) + ", " + listed(jet.direction) + ", " + number(jet.minimum) + ", " +
                    number(jet.maximum) + ", " + number(jet.lag) + ", " +
                    (jet.lag > 0 ? count(state++) : std::string("-1")) + "},\n";
        }
        out_ +=
            "static const struct {\n    double position[3], direction[3], minimum, maximum, lag;\n    int state;\n} "
            "jets[] = {\n" +
            (list.empty() ? "    {{0.0}, {0.0}, 0.0, 0.0, 0.0, -1}\n" : list) + "};\n";
    }

    void body() {
        const Vehicle& v = of_.model.vehicle;
        const Vector3 base = v.base_centre();
        constant("half_length", v.base_half_length);
        constant("contact_friction", of_.model.contact.friction);
        constant("buoyancy", v.mass * of_.model.environment.gravity - v.net_weight);
        out_ += "static const double buoyancy_centre[] = " + listed(v.buoyancy_centre()) + ";\n";
        law("drag_pitch", of_.model.drag_pitch);
        if (of_.motion == FmuMotion::heave_pitch) {
            const double speed = of_.held.get(Channel::speed, 0.0);
            constant("held_speed", speed);
            constant("base_depth", v.base_depth);
            constant("base_forward", base[0]);
            constant("pitch_inertia", v.pitch_inertia + v.added_inertia_pitch);
            constant("drag_moment", v.drag_height * drag(of_.model.drag_surge, of_.model.environment, speed));
            return;
        }
        out_ += "static const double base_place[] = " + listed(base) + ";\n";
        constant("mass_x", v.mass + v.added_mass_surge);
        constant("mass_y", v.mass + v.added_mass_sway);
        constant("drag_height", v.drag_height);
        constant("slip_speed", of_.model.contact.slip_speed);
        law("drag_surge", of_.model.drag_surge);
        law("drag_sway", of_.model.drag_sway);
        law("drag_yaw", of_.model.drag_yaw);
        const double xy = -v.inertia_product_xy, xz = -v.inertia_product_xz, yz = -v.inertia_product_yz;
        out_ += "static const double inertia_of[3][3] = {" +
                listed(Vector3{v.roll_inertia + v.added_inertia_roll, xy, xz}) + ", " +
                listed(Vector3{xy, v.pitch_inertia + v.added_inertia_pitch, yz}) + ", " +
                listed(Vector3{xz, yz, v.yaw_inertia + v.added_inertia_yaw}) + "};\n";
    }

    const MotionSource& of_;
    std::string out_;
    std::size_t grids_ = 0;
};

}  // namespace

bool MotionSource::moves(Channel channel) const {
    const auto in = [&](const std::vector<Channel>& list) {
        return std::find(list.begin(), list.end(), channel) != list.end();
    };
    return in(own) || in(varying);
}

std::string motion_code(const MotionSource& source) { return Code(source).text(); }

}  // namespace underbody::dynamics
