// A vehicle over the ground as declared in model.toml: value semantics, strict reading, exact writing back.
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/toml.h"
#include "core/water.h"
#include "surrogates/dynamics/model/channels.h"
#include "surrogates/dynamics/model/effect.h"
#include "surrogates/tables/fit/force_table.h"

namespace underbody::dynamics {

using Vector3 = std::array<double, 3>;

/// Body frame: x forward, y starboard, z down, origin at the centre of gravity. SI. NaN: not declared.
struct Vehicle {
    double mass = 0;  ///< required
    double added_mass_surge = 0, added_mass_sway = 0, added_mass_heave = 0;
    std::optional<tables::ForceTable> added_mass_heave_table;  ///< over gap; replaces the constant
    std::string added_mass_heave_file;
    double roll_inertia, pitch_inertia, yaw_inertia;
    double added_inertia_roll = 0, added_inertia_pitch = 0, added_inertia_yaw = 0;
    double inertia_product_xy = 0, inertia_product_xz = 0, inertia_product_yz = 0;  ///< integral of x y dm, ...
    double net_weight = 0;  ///< N, weight less buoyancy, positive sinks
    double length, width, height;
    double buoyancy_height = 0;  ///< centre of buoyancy above the centre of gravity, m (L_b), unless both centres stand
    /// Forward, starboard, down of the centre of the hull, m.
    std::optional<Vector3> centre_of_gravity, centre_of_buoyancy;
    double base_depth;  ///< base below the centre of gravity, m (L_nw)
    double base_half_length, base_half_width;
    double drag_height = 0;  ///< centre of surge drag above the centre of gravity, m (L_cgw): nose-up moment
    /// From the centre of gravity, body frame: the centre of buoyancy (a hull without declared centre: its middle), and
    /// the centre of the base, under the middle of the hull.
    [[nodiscard]] Vector3 buoyancy_centre() const;
    [[nodiscard]] Vector3 base_centre() const;
    Vehicle();
};

struct Environment {
    double density = core::default_water_density;  ///< kg/m^3
    double kinematic_viscosity = 1e-6;             ///< m^2/s
    double temperature = 293.15;                   ///< K
    double gravity = core::standard_gravity;       ///< m/s^2
};

/// Resistance with the sign of the velocity: F(w) w >= 0, subtracted from the equation of motion.
struct DragLaw {
    enum class Kind { linear_quadratic, mixed };
    Kind kind = Kind::linear_quadratic;
    double linear = 0;      ///< N s/m (rotation: N m s)
    double quadratic = 0;   ///< N s^2/m^2 (rotation: N m s^2)
    double length = 0.152;  ///< m, of the Reynolds number of the mixed law
};

/// force = factor * table(axes) * product of (max(0, |x| - dead_band) sgn x / (reference - dead_band))^exponent over
/// its scales
struct ForceScale {
    Channel channel = Channel::speed;
    double reference = 1;
    double exponent = 2;
    double dead_band = 0;
};

struct ForceSource {
    std::string quantity;              ///< lift_force, drag_force, side_force, pitch_moment, ...
    std::string table_file;            ///< as written in the model
    std::filesystem::path table_path;  ///< where it is
    tables::ForceTable table;
    std::vector<Channel> axes;  ///< channels of table.axes(), in their order
    std::vector<ForceScale> scales;
    double factor = 1;
};

/// A thruster. `direction` is that of the thrust ON the vehicle, unit length.
struct Jet {
    std::string name;
    Vector3 position{};
    Vector3 direction{};
    double minimum = 0;  ///< N
    double maximum = 0;  ///< N
    double lag = 0;      ///< s, time constant of its thrust
};

struct ContactLaw {
    double gap;  ///< the body touches at this gap, m; NaN: 0, or the lower end of tables that reach below 0
    double restitution = 0;
    double friction = 0;       ///< kinetic, Coulomb
    double slip_speed = 1e-3;  ///< m/s, of the smooth slip law
    ContactLaw();
};

/// How passive (speed) and jet-induced ground effect act together.
struct Coupling {
    enum class Kind {
        sum,        ///< both act as if alone (default)
        sheltered,  ///< the jet's part is weakened by the cross-flow: times 1/(1 + (speed/limit_speed)^2)
    };
    Kind kind = Kind::sum;
    double limit_speed = 1;  ///< m/s
};

/// How logs of this vehicle are read where they say something else than what acted: found by a discovery, or declared.
struct RecordReading {
    double input_factor = 1;                ///< input_force that acted over the logged one: -1 for a sign turned round
    double input_advance = 0;               ///< s: the logged input comes so long after it acted
    double others_advance = 0;              ///< s: so do the other recorded inputs, input_moment and thrust_NAME
    std::map<std::string, double> factors;  ///< of these, by column: what acted over what was logged
    double velocity_factor = 1;             ///< heave_velocity over the logged one
    enum class Between { unsaid, held, linear };
    Between input_between = Between::unsaid;  ///< what the input did between its samples
    bool operator==(const RecordReading&) const = default;
    /// Of any column.
    [[nodiscard]] double factor_of(const std::string& column) const;
    void scale(const std::string& column, double factor);
    /// s before a record's end: nothing is known of what acted later.
    [[nodiscard]] double last_unknown() const { return std::max(input_advance, others_advance); }
};

struct Lineage {
    std::vector<std::string> made_from;  ///< lines for people: files, hashes, what was done
};

/// A declared number by its dotted name, for `declared_parameter`, variants and help.
struct DeclaredParameter {
    std::string
        name;  ///< "vehicle.mass", "drag.heave.quadratic", "force.1.factor", "force.1.scale.speed.exponent", ...
    std::string unit;
    double value = 0;
    double lower = 0, upper = 0;  ///< what a reader accepts
    bool declared = false;        ///< it stands in the file (else a default)
    std::string meaning;
};

struct Model {
    std::string name;            ///< file name, for messages
    std::filesystem::path file;  ///< where it was read; empty for one made in memory
    Vehicle vehicle;
    Environment environment;
    DragLaw drag_surge, drag_sway, drag_heave, drag_pitch, drag_yaw;
    std::vector<ForceSource> forces;
    std::vector<Jet> jets;
    ContactLaw contact;
    Coupling coupling;
    Conditions conditions;  ///< [conditions]: held values where nothing else is said
    std::vector<EffectUse> effects;
    RecordReading records;  ///< [records]
    Lineage lineage;
    core::Problems remarks;  ///< what the user should know: defaults taken, unusual values

    /// The text it was read from, without its [[effect]], [records] and [lineage] parts.
    std::string base_text;
    /// Dotted names of parameters changed since (written as declared_parameter effects).
    std::vector<std::string> changed;
    std::vector<std::string> declared;  ///< dotted names that stand in the file

    /// Every declared number, with its bounds. Forces count from 1.
    [[nodiscard]] std::vector<DeclaredParameter> parameters() const;
    /// Throws core::InputError with the nearest name.
    [[nodiscard]] double parameter(const std::string& dotted_name) const;
    [[nodiscard]] Model with_parameter(const std::string& dotted_name, double value) const;
    [[nodiscard]] Model with_effect(EffectUse use) const;
    /// declared_parameter effects carried out (and removed from the list).
    [[nodiscard]] Model resolved() const;
    /// Virtual mass in heave far from the ground.
    [[nodiscard]] double heave_mass() const { return vehicle.mass + vehicle.added_mass_heave; }
    /// The measured quantities its force sources give, in their order.
    [[nodiscard]] std::vector<std::string> quantities() const;
};

/// Strict: unknown keys, wrong units, values out of range (with a hint of the likely slip) throw core::InputError.
Model read_model(const std::filesystem::path& file);
Model read_model_text(std::string_view text, const std::string& source, const std::filesystem::path& folder);

/// Writes the model so that read_model gives the same one: the original text kept, effects and lineage appended,
/// its tables copied beside it (same relative names where they lie below the model, else by file name).
void write_model(const Model& model, const std::filesystem::path& file);

/// The reference of each channel that scales forces, where all its scales have one. What nobody gives is at its
/// reference, for a scale as for the effects and corrections beside it: they are forces of one motion.
Conditions references_of(const Model& model);

/// A measured quantity (lift_force, drag_force, side_force, pitch_moment, ...) at a set point: sum of the model's
/// sources of that quantity, with its static effects. `outside` becomes true when a table was asked beyond its range.
/// Throws core::InputError when the set point lacks a channel that a table or scale needs and the model holds no value
/// for it (what scales a force and has no value is at its reference, for effects and corrections too).
double static_value(const Model& model, const std::string& quantity, const Conditions& set_point,
                    bool* outside = nullptr);

/// Sum of the model's sources of that quantity alone, without effects.
double sum_of_sources(const Model& model, const std::string& quantity, const Conditions& seen, bool* outside = nullptr);

/// static_value, compiled once for many points: no look-up by name, declared_parameter already carried out.
class StaticModel {
public:
    StaticModel(const Model& model, const std::string& quantity);
    double operator()(const Conditions& set_point, bool* outside = nullptr) const;
    /// The conditions that the force tables are asked at: the set point over the model's own, changed by its effects.
    [[nodiscard]] Conditions seen(const Conditions& set_point) const;
    [[nodiscard]] const Model& model() const { return model_; }

private:
    [[nodiscard]] StaticPoint before(const Conditions& set_point) const;
    Model model_;
    std::string quantity_;
    std::vector<const Effect*> kinds_;
};

}  // namespace underbody::dynamics
