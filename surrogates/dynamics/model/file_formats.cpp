#include "surrogates/dynamics/model/file_formats.h"

#include <cmath>
#include <map>

#include "core/text.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model_items.h"

namespace underbody::dynamics {

namespace file_keys {

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) {
        text += (text.empty() ? "" : " | ") + word;
    }
    return text;
}

/// Values of a plausible vehicle, by section and key; other items show their default.
std::string example_of(const std::string& name) {
    static const std::map<std::string, std::string> examples = {
        {"vehicle.mass", "\"2.2 kg\""},
        {"vehicle.added_mass_surge", "\"0.8 kg\""},
        {"vehicle.added_mass_sway", "\"1.3 kg\""},
        {"vehicle.added_mass_heave", "\"1.754 kg\""},
        {"vehicle.roll_inertia", "\"0.0049 kg m^2\""},
        {"vehicle.pitch_inertia", "\"0.0069 kg m^2\""},
        {"vehicle.yaw_inertia", "\"0.0071 kg m^2\""},
        {"vehicle.added_inertia_roll", "\"8.7e-6 kg m^2\""},
        {"vehicle.added_inertia_pitch", "\"5.1e-4 kg m^2\""},
        {"vehicle.added_inertia_yaw", "\"3.8e-4 kg m^2\""},
        {"vehicle.inertia_product_xy", "\"0 kg m^2\""},
        {"vehicle.inertia_product_xz", "\"0 kg m^2\""},
        {"vehicle.inertia_product_yz", "\"0 kg m^2\""},
        {"vehicle.net_weight", "\"0.03 N\""},
        {"vehicle.length", "\"203.2 mm\""},
        {"vehicle.width", "\"152 mm\""},
        {"vehicle.height", "\"145 mm\""},
        {"vehicle.buoyancy_height", "\"20 mm\""},
        {"vehicle.base_depth", "\"31.4 mm\""},
        {"vehicle.base_half_length", "\"71.7 mm\""},
        {"vehicle.base_half_width", "\"53.6 mm\""},
        {"vehicle.drag_height", "\"20 mm\""},
        {"environment.density", "\"998 kg/m^3\""},
        {"environment.kinematic_viscosity", "\"1.0e-6 m^2/s\""},
        {"environment.temperature", "\"20 degC\""},
        {"environment.gravity", "\"9.80665 m/s^2\""},
        {"drag.heave.linear", "\"0.05 N s/m\""},
        {"drag.heave.quadratic", "\"15 N s^2/m^2\""},
        {"contact.gap", "\"0 mm\""},
        {"contact.friction", "0.4"},
        {"contact.slip_speed", "\"1 mm/s\""},
        {"coupling.limit_speed", "\"1.35 m/s\""},
    };
    const auto found = examples.find(name);
    return found == examples.end() ? std::string() : found->second;
}

std::string with_unit(double value, const std::string& unit) {
    return core::format_number(value, 6) + (unit == "1" ? "" : " " + unit);
}

/// What an undeclared number is: the value that a new model has.
std::string fallback_of(const ModelItem& item) {
    static const std::map<std::string, std::string> said = {
        {"vehicle.base_depth", "none: motions with pitch or contact need it"},
        {"contact.gap", "0, or the lower end of tables that reach below 0"},
    };
    if (item.required) {
        return {};
    }
    const std::string name = std::string(item.section) + "." + item.key;
    if (const auto found = said.find(name); found != said.end()) {
        return found->second;
    }
    Model model;
    const double value = item.of(model);
    return std::isnan(value) ? "none: asked for where it is needed" : with_unit(value, item.unit);
}

core::FileTable items_of(const std::string& section, const std::string& meaning) {
    core::FileTable table{section, meaning, {}, false, {}};
    for (const ModelItem& item : model_items()) {
        if (section != item.section) {
            continue;
        }
        Model model;
        std::string example = example_of(section + "." + item.key);
        if (example.empty()) {
            const double value = item.of(model);
            example = "\"" + with_unit(std::isnan(value) ? item.lower : value, item.unit) + "\"";
        }
        table.keys.push_back({item.key, item.unit, example, fallback_of(item), item.meaning});
    }
    return table;
}

core::FileTable vehicle() {
    core::FileTable table = items_of("vehicle", "mass, inertia and size of the vehicle");
    table.required = true;
    for (core::FileKey& key : table.keys) {
        if (key.name == "added_mass_heave") {
            key.meaning += "; or the name of a CSV table over gap";
        }
    }
    table.keys.push_back({"centre_of_gravity", "list of m", "[\"0 mm\", \"0 mm\", \"20 mm\"]", "the centre of the hull",
                          "forward, starboard, down of the centre of the hull"});
    table.keys.push_back({"centre_of_buoyancy", "list of m", "[\"0 mm\", \"0 mm\", \"0 mm\"]",
                          "buoyancy_height above the centre of gravity",
                          "forward, starboard, down of the centre of the hull"});
    return table;
}

core::FileTable drag(const std::string& direction) {
    core::FileTable table =
        items_of("drag." + direction, "resistance in " + direction + ", subtracted from the equation of motion");
    table.keys.insert(table.keys.begin(),
                      {"law", "linear_quadratic | mixed", "\"linear_quadratic\"", "linear_quadratic",
                       "linear + quadratic, or linear below Reynolds number 1 and quadratic above 1000"});
    return table;
}

std::vector<core::FileTable> forces() {
    return {
        {"force[]",
         "a force or moment from a table; several of one quantity add up",
         {{"quantity", joined(force_channels()), "\"lift_force\"", "", "what the table holds"},
          {"table", "file", "\"lift.csv\"", "", "CSV table, relative to this file; its other columns are its axes"},
          {"axes", "list of texts", "[\"gap\"]", "all columns that are states or conditions", "columns that are axes"},
          {"fit", "automatic | interpolation | spline | gaussian_process", "\"automatic\"", "automatic",
           "how values between the points are found"},
          {"factor", "1", "1.0", "1", "factor on the table's values"}}},
        {"force[].scale.*",
         "the force grows as (condition / reference)^exponent; * is the name of the condition: speed, jet_voltage",
         {{"reference", "the unit of the condition", "\"0.5 m/s\"", "", "condition at which the table was made"},
          {"exponent", "1", "2", "2", "power"},
          {"dead_band", "the unit of the condition", "0", "0", "below this the force is zero"}},
         false,
         "scale.speed = { reference = \"0.5 m/s\", exponent = 2 }"}};
}

core::FileTable jet() {
    return {"jet[]",
            "a thruster",
            {{"name", "text", "\"J1\"", "", "its name"},
             {"position", "list of m", "[\"-80 mm\", \"50 mm\", \"-30 mm\"]", "",
              "forward, starboard, down of the centre of gravity"},
             {"direction", "list of 1", "[1, 0, 0]", "", "of the thrust ON the vehicle; any length"},
             {"minimum", "N", "\"0 N\"", "0", "least thrust"},
             {"maximum", "N", "\"0.6 N\"", "", "largest thrust"},
             {"lag", "s", "\"50 ms\"", "0", "time constant of its thrust"}}};
}

std::vector<core::FileTable> effect_tables() {
    return {{"effect[]",
             "an effect that is part of the model; a discovery writes what it found here",
             {{"name", "text", "\"coulomb_friction\"", "", "name in the catalogue of effects"},
              {"*", "the unit of the parameter", "force = { value = \"0.0098 N\", sigma = \"0.0004 N\" }", "",
               "a parameter of the effect: a quantity, or value and standard deviation"},
              {"quantity", "text", "\"lift_force\"", "every quantity it can change",
               "of effects on measured forces: the one that it changes"},
              {"parameter", "text", "\"vehicle.mass\"", "none", "of declared_parameter: the number that is changed"},
              {"table", "file", "\"correction.csv\"", "none", "of unknown: the table of the correction"},
              {"probability", "1", "0.97", "none", "of a discovery; not read"},
              {"evidence", "text", "\"\"", "none", "of a discovery; not read"},
              {"depends_on", "list of texts", "[\"heave_velocity\"]", "none", "of a discovery; not read"},
              {"source", "text", "\"\"", "none", "of a discovery; not read"}}},
            {"effect[].*",
             "a parameter with its error",
             {{"value", "the unit of the parameter", "\"0.0098 N\"", "", "its value"},
              {"sigma", "the unit of the parameter", "\"0.0004 N\"", "0", "one standard deviation"},
              {"unit", "text", "\"N\"", "none", "for people; not read"}},
             false,
             "force = { value = \"0.0098 N\", sigma = \"0.0004 N\" }"}};
}

core::FileTable held_conditions(const std::string& path, const std::string& meaning) {
    return {path,
            meaning,
            {{"*", "the unit of the quantity", "speed = \"0.5 m/s\"", "",
              "a state or condition by its name: speed, jet_voltage, temperature"}}};
}

}  // namespace file_keys

const core::FileFormat& model_format() {
    static const core::FileFormat format = [] {
        core::FileFormat made{"model", "model.toml", "a vehicle over the ground", {}};
        made.tables.push_back(
            {"", "What stands before the first table", {{"title", "text", "\"EVIE\"", "none", "for people"}}});
        made.tables.push_back(file_keys::vehicle());
        made.tables.push_back(file_keys::items_of("environment", "the water"));
        made.tables.push_back(
            file_keys::held_conditions("conditions", "conditions that hold where nothing else is said"));
        for (const char* direction : {"heave", "surge", "sway", "pitch", "yaw"}) {
            made.tables.push_back(file_keys::drag(direction));
        }
        made.tables.push_back(file_keys::items_of("contact", "contact with the ground"));
        core::FileTable coupling =
            file_keys::items_of("coupling", "how passive and jet-induced ground effect act together");
        coupling.keys.insert(coupling.keys.begin(), {"law", "sum | sheltered", "\"sum\"", "sum",
                                                     "both as if alone, or the jet's part weakened by cross-flow"});
        made.tables.push_back(std::move(coupling));
        for (auto& table : file_keys::forces()) {
            made.tables.push_back(std::move(table));
        }
        made.tables.push_back(file_keys::jet());
        for (auto& table : file_keys::effect_tables()) {
            made.tables.push_back(std::move(table));
        }
        made.tables.push_back(
            {"records",
             "how logs of this vehicle are read where they say something else than what acted; a discovery writes it",
             {{"input_force_between", "held | linear", "\"linear\"", "what fits the data better",
               "what the input did between its samples"},
              {"input_force_factor", "1", "-1", "1",
               "input that acted over the logged one: -1 for a sign turned round"},
              {"input_force_advance", "s", "\"0.1 s\"", "0",
               "the logged input comes so long after it acted; below zero (a part of a sample): before it"},
              {"other_inputs_advance", "s", "\"0.1 s\"", "0", "so do input_moment and the thrusts of jets"},
              {"heave_velocity_factor", "1", "-1", "1", "heave velocity over the logged one"}}});
        made.tables.push_back({"records.factors",
                               "what acted over what was logged, of the inputs beside input_force",
                               {{"*", "1", "input_moment = -1", "", "a recorded input: input_moment or thrust_NAME"}}});
        made.tables.push_back(
            {"lineage",
             "what a written model was made of",
             {{"made_from", "list of texts", "[\"model.toml\"]", "none", "files and what was done"}}});
        return made;
    }();
    return format;
}

namespace {

/// How channels come out of logs.
std::vector<core::FileTable> log_tables() {
    std::vector<core::FileTable> made;
    made.push_back({"log",
                    "how runs that are vehicles' logs are read, or CSV files with headings of their own",
                    {{"clock", "text", "\"header.stamp\"", "the log's own times (CSV: the column time)",
                      "field of each channel's message that says when it was measured"},
                     {"clock_unit", "text", "\"us\"", "s", "unit of a clock that does not state its own"}}});
    made.push_back({"log.channel.*",
                    "one channel, by the name of its quantity: offset + scale * sign * number",
                    {{"message", "text", "\"RFND\"", "none: a column of a CSV file",
                      "message or topic as `underbody info` lists it; \"RFND[1]\" is the second sensor"},
                     {"field", "text", "\"Dist\"", "", "field of the message, or heading of the column"},
                     {"unit", "text", "\"cm\"", "what the log states, or SI", "unit of the number"},
                     {"scale", "1", "0.5", "1", "multiplies the number"},
                     {"sign", "1 | -1", "-1", "1", "-1 turns the number round: a log whose z points down"},
                     {"offset", "the unit of the quantity", "\"12 mm\"", "0", "added last"},
                     {"clock", "text", "\"timestamp_sample\"", "the one of [log]",
                      "field of the message that says when it was measured"},
                     {"clock_unit", "text", "\"ms\"", "the one of [log]", "unit of that field where it states none"},
                     {"clock_scale", "1", "1.0003", "1", "multiplies its times: a clock that runs at another rate"},
                     {"clock_offset", "s", "\"-0.35 s\"", "0",
                      "added to its times: a sensor whose clock began at another moment"}}});
    made.back().one_line = "channel.gap = { message = \"RFND\", field = \"Dist\" }";
    return made;
}

}  // namespace

const core::FileFormat& dataset_format() {
    static const core::FileFormat format = [] {
        core::FileFormat made{"dataset", "dataset.toml", "measurements: a folder of runs", {}};
        made.tables.push_back(
            {"",
             "What stands before the first table",
             {{"kind", "time_series | static", "\"time_series\"", "",
               "runs in time, or set points with measured forces"},
              {"title", "text", "\"heave tests over a flat ground\"", "none", "for people"},
              {"motion", "heave | heave_pitch | surface | body", "\"heave_pitch\"",
               "heave_pitch where every run's pitch moves and the model declares pitch",
               "which motion the runs are of: pitch moves freely with heave, or as something else "
               "makes it; surface: flat on the ground, driven by its jets; body: the whole vehicle off "
               "the ground, roll held at zero"}},
             true});
        made.tables.push_back(
            {"noise",
             "one standard deviation of each sensor; left out, it is estimated from the data",
             {{"*", "the unit of the quantity", "gap = \"0.2 mm\"", "", "a measured quantity by its name"}}});
        made.tables.push_back(file_keys::held_conditions("conditions", "conditions of all runs"));
        made.tables.push_back({"run[]",
                               "one file of measurements",
                               {{"file", "file", "\"run-01.csv\"", "",
                                 "CSV table, or a vehicle's log (PX4 ULog, ArduPilot DataFlash, ROS 2 bag: also the "
                                 "bag's folder), relative to this file"},
                                {"use", "train | test", "\"test\"", "the program splits by whole runs and says how",
                                 "what the run is for"},
                                {"begin", "s", "\"12 s\"", "the file's beginning",
                                 "the run begins there, by the file's clock; several runs may come from one file"},
                                {"end", "s", "\"40 s\"", "the file's end", "the run ends there"}},
                               true});
        core::FileTable own =
            file_keys::held_conditions("run[].conditions", "conditions of this run, over those of all");
        own.one_line = "conditions = { jet_voltage = \"10 V\" }";
        made.tables.push_back(std::move(own));
        for (auto& table : log_tables()) {
            made.tables.push_back(std::move(table));
        }
        return made;
    }();
    return format;
}

}  // namespace underbody::dynamics
