#include <algorithm>
#include <cmath>

#include "core/file.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/dynamics/model/file_formats.h"
#include "surrogates/dynamics/model/mixed_drag.h"
#include "surrogates/dynamics/model/model_items.h"
#include "surrogates/tables/points/select.h"

namespace underbody::dynamics {

namespace {

constexpr double not_given = std::numeric_limits<double>::quiet_NaN();

core::TomlTable section_of(const core::TomlTable& root, const std::string& dotted) {
    core::TomlTable table = root;
    for (const std::string_view part : core::split(dotted, '.')) {
        table = table.table_or_empty(part);
    }
    return table;
}

void read_items(Model& model, const core::TomlTable& root) {
    for (const ModelItem& item : model_items()) {
        const core::TomlTable section = section_of(root, item.section);
        if (std::string(item.section) == "vehicle" && std::string(item.key) == "added_mass_heave" &&
            section.is_string(item.key) && section.string(item.key).ends_with(".csv")) {
            model.vehicle.added_mass_heave_file = section.string(item.key);
            tables::FitOptions options;
            options.axes = {"gap"};
            model.vehicle.added_mass_heave_table =
                tables::ForceTable::fit(core::read_csv(section.file(item.key)), "added_mass_heave", options);
            continue;
        }
        if (item.required || section.has(item.key)) {
            const double value = section.quantity(item.key, item.unit);
            check_item(item, value, section.place(item.key));
            item.of(model) = value;
            model.declared.push_back(std::string(item.section) + "." + item.key);
        }
    }
}

void read_drag_laws(Model& model, const core::TomlTable& root) {
    const core::TomlTable drag = root.table_or_empty("drag");
    const std::pair<const char*, DragLaw*> all[] = {{"surge", &model.drag_surge},
                                                    {"sway", &model.drag_sway},
                                                    {"heave", &model.drag_heave},
                                                    {"pitch", &model.drag_pitch},
                                                    {"yaw", &model.drag_yaw}};
    for (const auto& [name, law] : all) {
        const core::TomlTable table = drag.table_or_empty(name);
        const bool mixed = table.choice("law", {"linear_quadratic", "mixed"}, "linear_quadratic") == "mixed";
        law->kind = mixed ? DragLaw::Kind::mixed : DragLaw::Kind::linear_quadratic;
        if (mixed &&
            !MixedDrag(law->linear, law->quadratic, law->length, model.environment.kinematic_viscosity).monotone) {
            model.remarks.push_back({core::Problem::Severity::warning,
                                     std::string("mixed drag in ") + name +
                                         " falls with speed between its two laws: linear is more "
                                         "than 2.382 times quadratic times the speed of Reynolds number 1000",
                                     table.place("linear")});
        }
    }
}

Vector3 read_vector(const core::TomlTable& table, const char* key, const char* unit) {
    const std::vector<double> numbers = table.quantities(key, unit);
    if (numbers.size() != 3) {
        throw core::InputError("type", table.path_of(key) + " needs three numbers (forward, starboard, down)",
                               table.place(key));
    }
    return {numbers[0], numbers[1], numbers[2]};
}

std::optional<Vector3> read_centre(const core::TomlTable& vehicle, const char* key) {
    return vehicle.has(key) ? std::optional<Vector3>(read_vector(vehicle, key, "m")) : std::nullopt;
}

ForceScale read_scale(const core::TomlTable& scales, const std::string& name) {
    ForceScale scale;
    if (!find_channel(name, scale.channel)) {
        throw core::InputError("name", "scale." + name + " is not a condition", scales.place(name),
                               core::did_you_mean(name, channel_names()));
    }
    const core::TomlTable table = scales.table(name);
    scale.reference = table.quantity("reference", channel_unit(scale.channel));
    scale.exponent = table.find_quantity("exponent", "1").value_or(2.0);
    scale.dead_band = table.find_quantity("dead_band", channel_unit(scale.channel)).value_or(0.0);
    if (!(scale.reference > 0) || scale.dead_band < 0 || scale.dead_band >= scale.reference) {
        throw core::InputError("range", "scale." + name + ": reference must be positive and more than dead_band",
                               table.place("reference"));
    }
    if (std::abs(scale.exponent) > 10) {
        throw core::InputError("range",
                               "scale." + name + ": exponent " + core::format_number(scale.exponent) + " cannot be",
                               table.place("exponent"), "squared speed is exponent = 2");
    }
    return scale;
}

/// A table that this program exported is taken as it was. It may refuse or extrapolate beyond its ends, but a motion
/// cannot stop being in the middle: there every table holds its end values, and the result counts the places.
std::optional<tables::ForceTable> exported_table(const core::Table& points, const std::string& quantity,
                                                 tables::FitOptions options, const core::Place& place,
                                                 core::Problems& remarks) {
    auto table = tables::ForceTable::exported(points, quantity, options);
    bool holds = true;
    for (std::size_t k = 0; table && k < table->axes().size(); ++k) {
        const tables::TableAxis& axis = table->axes()[k];
        if (axis.range != tables::RangePolicy::clamp) {
            holds = false;
            remarks.push_back({core::Problem::Severity::warning,
                               "the table asks to " + to_string(axis.range) + " beyond the ends of " + axis.name +
                                   ": in a model every table holds its end values",
                               place});
        }
    }
    if (!holds) {
        options.range = tables::RangePolicy::clamp;
        table = tables::ForceTable::exported(points, quantity, options);
    }
    return table;
}

/// Each axis of a table must be a state or a condition.
void take_axes(ForceSource& source, const core::TomlTable& table) {
    for (const tables::TableAxis& axis : source.table.axes()) {
        Channel channel{};
        if (!find_channel(axis.name, channel)) {
            throw core::InputError(
                "name", "axis '" + axis.name + "' of " + source.table_file + " is not a state or a condition",
                table.place("table"), core::did_you_mean(axis.name, channel_names()));
        }
        source.axes.push_back(channel);
    }
}

void take_scales(ForceSource& source, const core::TomlTable& scales) {
    for (const std::string& name : scales.keys()) {
        source.scales.push_back(read_scale(scales, name));
        if (std::find(source.axes.begin(), source.axes.end(), source.scales.back().channel) != source.axes.end()) {
            throw core::InputError("range", "scale." + name + ": the table already has " + name + " as an axis",
                                   scales.place(name), "leave one of the two out, or name the axes: axes = [\"gap\"]");
        }
    }
}

/// Forces grow with the density: a table of one water is not that of another.
void remark_on_water(Model& model, const ForceSource& source) {
    const core::Column* density = source.table.points().find("density");
    if (density == nullptr || density->is_text() || density->numbers.empty()) {
        return;
    }
    const auto [low, high] = std::minmax_element(density->numbers.begin(), density->numbers.end());
    const double own = model.environment.density;
    constexpr double same = 2e-3;  // fresh water between 4 and 25 degrees
    if (*low == *high && std::abs(*low - own) > same * own) {
        model.remarks.push_back({core::Problem::Severity::warning,
                                 "the " + source.quantity + " table is of water of " + core::format_number(*low, 6) +
                                     " kg/m^3, the model's is of " + core::format_number(own, 6) +
                                     " kg/m^3: the table's forces are taken as they are",
                                 {source.table_path.string(), {}, {}, {}}});
    }
}

ForceSource read_force(const core::TomlTable& table, core::Problems& remarks) {
    const std::string quantity = table.choice(
        "quantity", {"lift_force", "drag_force", "side_force", "pitch_moment", "roll_moment", "yaw_moment"});
    const core::Table points = tables::read_points(table.file("table"));
    tables::FitOptions options;
    if (table.has("axes")) {
        options.axes = table.strings("axes");
    }
    const std::string fit = table.string_or("fit", "automatic");
    const auto kind = tables::fit_kind(fit);
    if (!kind) {
        throw core::InputError("name", table.path_of("fit") + ": '" + fit + "' is not known", table.place("fit"),
                               core::did_you_mean(fit, tables::fit_kinds()));
    }
    options.kind = *kind;
    // The same rule as everywhere: what is fitted here is what the commands on tables and a study's report show.
    const auto fitted = [&] {
        if (*kind == tables::FitOptions::Kind::automatic) {
            if (auto table_as_it_was = exported_table(points, quantity, options, table.place("table"), remarks)) {
                return *table_as_it_was;
            }
        }
        return tables::ForceTable::fit(points, quantity, options);
    };
    ForceSource source{quantity,
                       table.string("table"),
                       table.file("table"),
                       fitted(),
                       {},
                       {},
                       table.find_quantity("factor", "1").value_or(1.0)};
    for (const core::Problem& remark : source.table.remarks()) {
        if (remark.severity != core::Problem::Severity::note) {
            remarks.push_back(remark);
        }
    }
    take_axes(source, table);
    take_scales(source, table.table_or_empty("scale"));
    return source;
}

Jet read_jet(const core::TomlTable& table) {
    Jet jet;
    jet.name = table.string("name");
    jet.position = read_vector(table, "position", "m");
    jet.direction = read_vector(table, "direction", "1");
    const double size = std::hypot(jet.direction[0], jet.direction[1], jet.direction[2]);
    constexpr double least_length = 1e-9;
    if (!(size > least_length)) {
        throw core::InputError("range", "jet " + jet.name + " has no direction", table.place("direction"));
    }
    for (double& part : jet.direction) {
        part /= size;
    }
    jet.minimum = table.find_quantity("minimum", "N").value_or(0.0);
    jet.maximum = table.quantity("maximum", "N");
    jet.lag = table.find_quantity("lag", "s").value_or(0.0);
    if (jet.maximum < jet.minimum || jet.lag < 0) {
        throw core::InputError("range", "jet " + jet.name + ": maximum below minimum, or negative lag",
                               table.place("maximum"));
    }
    return jet;
}

std::pair<double, double> read_value(const core::TomlTable& table, const std::string& key, const std::string& unit) {
    if (table.is_table(key)) {
        const core::TomlTable inner = table.table(key);
        inner.accept("unit");
        return {inner.quantity("value", unit), inner.find_quantity("sigma", unit).value_or(0.0)};
    }
    return {table.quantity(key, unit), 0.0};
}

EffectUse read_effect(const Model& model, const core::TomlTable& table) {
    const std::string name = table.string("name");
    if (!find_effect(name)) {
        std::vector<std::string> known;
        for (const Effect* kind : effects()) {
            known.push_back(kind->info().name);
        }
        throw core::InputError("name", "no effect is called '" + name + "'", table.place("name"),
                               core::did_you_mean(name, known));
    }
    const EffectInfo& info = effect(name).info();
    EffectUse use = neutral_use(name);
    if (info.takes_quantity) {
        use.quantity = table.string_or("quantity", "");
    }
    std::string parameter_unit = "1";
    if (info.takes_parameter) {
        use.parameter = table.string("parameter");
        static_cast<void>(model.parameter(use.parameter));  // throws with the nearest name
        for (const DeclaredParameter& declared : model.parameters()) {
            parameter_unit = declared.name == use.parameter ? declared.unit : parameter_unit;
        }
    }
    if (info.takes_table) {
        use.table_file = table.string("table");
        const core::Table points = core::read_csv(table.file("table"));
        use.table = tables::ForceTable::fit(points, use.quantity.empty() ? "lift_force" : use.quantity);
    }
    for (std::size_t i = 0; i < info.parameters.size(); ++i) {
        const EffectParameter& parameter = info.parameters[i];
        if (!table.has(parameter.name) && parameter.shape) {
            continue;
        }
        const auto [value, sigma] =
            read_value(table, parameter.name, parameter.unit == "parameter" ? parameter_unit : parameter.unit);
        use.values[i] = value;
        use.sigmas[i] = sigma;
    }
    for (const char* known : {"probability", "evidence", "depends_on", "source"}) {
        table.accept(known);
    }
    check_use(use, table.place("name"));
    return use;
}

RecordReading read_records(const core::TomlTable& table, const std::vector<Jet>& jets) {
    RecordReading records;
    const auto factor = [](const core::TomlTable& of, const std::string& key, double& value) {
        if (of.has(key)) {
            value = of.quantity(key, "1");
            if (!(std::abs(value) > 0) || !std::isfinite(value)) {
                throw core::InputError("range", of.path_of(key) + " must not be zero", of.place(key));
            }
        }
    };
    factor(table, "input_force_factor", records.input_factor);
    factor(table, "heave_velocity_factor", records.velocity_factor);
    const auto advance = [&](const char* key, double least, double& value) {
        value = table.quantity_or(key, "s", 0);
        if (!(value >= least) || value > 30) {
            throw core::InputError(
                "range",
                std::string("records.") + key + " must lie between " + core::format_number(least, 1) + " and 30 s",
                table.place(key), "an input that acts later than it was logged is the effect input_delay");
        }
    };
    // Below zero: a log that stamps an input within the sample before it acts; discovery finds such parts of a sample.
    advance("input_force_advance", -1, records.input_advance);
    advance("other_inputs_advance", 0, records.others_advance);
    std::vector<std::string> columns{"input_moment"};
    for (const Jet& jet : jets) {
        columns.push_back("thrust_" + jet.name);
    }
    const core::TomlTable factors = table.table_or_empty("factors");
    for (const std::string& column : factors.keys()) {
        if (std::find(columns.begin(), columns.end(), column) == columns.end()) {
            throw core::InputError("name", factors.path_of(column) + " is no recorded input of this vehicle",
                                   factors.place(column), core::did_you_mean(column, columns));
        }
        factor(factors, column, records.factors[column]);
    }
    const std::string between = table.choice("input_force_between", {"held", "linear"}, "");
    records.input_between = between.empty()     ? RecordReading::Between::unsaid
                            : between == "held" ? RecordReading::Between::held
                                                : RecordReading::Between::linear;
    return records;
}

/// The text without its [[effect]], [records] and [lineage] parts, which the writer makes anew.
std::string without_written_parts(std::string_view text) {
    std::string kept;
    bool skipping = false;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        const std::string_view line = text.substr(0, end == std::string_view::npos ? text.size() : end + 1);
        text.remove_prefix(line.size());
        const std::string_view bare = core::trimmed(line);
        const std::size_t letter = bare.find_first_not_of("[ \t");
        if (bare.starts_with('[') && letter != std::string_view::npos &&
            std::isalpha(static_cast<unsigned char>(bare[letter]))) {
            const std::string_view title = bare.substr(letter);
            const auto is = [&title](std::string_view word) {
                return title.starts_with(word) && title.size() > word.size() &&
                       (title[word.size()] == ']' || title[word.size()] == '.' || title[word.size()] == ' ');
            };
            skipping = is("effect") || is("records") || is("lineage");
        }
        if (!skipping) {
            kept += line;
        }
    }
    while (kept.ends_with("\n\n")) {
        kept.pop_back();
    }
    return kept;
}

Model read(const core::TomlTable& root, std::string_view text) {
    Model model;
    read_items(model, root);
    model.vehicle.centre_of_gravity = read_centre(root.table("vehicle"), "centre_of_gravity");
    model.vehicle.centre_of_buoyancy = read_centre(root.table("vehicle"), "centre_of_buoyancy");
    read_drag_laws(model, root);
    const core::TomlTable coupling = root.table_or_empty("coupling");
    model.coupling.kind = coupling.choice("law", {"sum", "sheltered"}, "sum") == "sheltered" ? Coupling::Kind::sheltered
                                                                                             : Coupling::Kind::sum;
    const core::TomlTable conditions = root.table_or_empty("conditions");
    for (const std::string& name : conditions.keys()) {
        Channel channel{};
        if (!find_channel(name, channel)) {
            throw core::InputError("name", "conditions." + name + " is not known", conditions.place(name),
                                   core::did_you_mean(name, channel_names()));
        }
        model.conditions[channel] = conditions.quantity(name, channel_unit(channel));
    }
    for (const core::TomlTable& table : root.tables("force")) {
        model.forces.push_back(read_force(table, model.remarks));
        remark_on_water(model, model.forces.back());
    }
    for (const core::TomlTable& table : root.tables("jet")) {
        Jet jet = read_jet(table);
        if (std::any_of(model.jets.begin(), model.jets.end(), [&](const Jet& one) { return one.name == jet.name; })) {
            throw core::InputError("name", "two jets are called '" + jet.name + "'", table.place("name"),
                                   "give each a name of its own: thrusts and voltages are named after it");
        }
        model.jets.push_back(std::move(jet));
    }
    for (const core::TomlTable& table : root.tables("effect")) {
        model.effects.push_back(read_effect(model, table));
    }
    model.records = read_records(root.table_or_empty("records"), model.jets);
    const core::TomlTable lineage = root.table_or_empty("lineage");
    if (lineage.has("made_from")) {
        model.lineage.made_from = lineage.strings("made_from");
    }
    root.accept("title");
    root.finish();
    check_model(model, root);
    model.base_text = without_written_parts(text);
    return model;
}

}  // namespace

Vehicle::Vehicle()
    : roll_inertia(not_given),
      pitch_inertia(not_given),
      yaw_inertia(not_given),
      length(not_given),
      width(not_given),
      height(not_given),
      base_depth(not_given),
      base_half_length(not_given),
      base_half_width(not_given) {}

Vector3 Vehicle::buoyancy_centre() const {
    if (!centre_of_gravity && !centre_of_buoyancy) {
        return {0, 0, -buoyancy_height};
    }
    const Vector3 g = centre_of_gravity.value_or(Vector3{}), b = centre_of_buoyancy.value_or(Vector3{});
    return {b[0] - g[0], b[1] - g[1], b[2] - g[2]};
}

Vector3 Vehicle::base_centre() const {
    const Vector3 g = centre_of_gravity.value_or(Vector3{});
    return {-g[0], -g[1], base_depth};
}

ContactLaw::ContactLaw() : gap(not_given) {}

Model read_model_text(std::string_view text, const std::string& source, const std::filesystem::path& folder) {
    Model model = read(core::read_toml_text(text, source, folder, model_format()), text);
    model.name = source;
    return model;
}

Model read_model(const std::filesystem::path& file) {
    Model model = read(core::read_toml(file, model_format()), core::read_file(file));
    model.name = file.string();
    model.file = file;
    return model;
}

}  // namespace underbody::dynamics
