#include "geometry/body/variants.h"

#include <cmath>
#include <map>

#include "core/error.h"
#include "core/parallel.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/body/body_surface.h"
#include "geometry/body/exact_body.h"
#include "geometry/body/loading.h"
#include "geometry/body/shape_format.h"

namespace underbody::geometry {

std::string parameter_unit(const std::string& key, const core::Place& place) {
    std::vector<std::string> known;
    for (const ParameterName& p : parameter_names()) {
        if (p.name == key) {
            return p.unit;
        }
        known.push_back(p.name);
    }
    throw core::InputError("name", "a shape has no parameter '" + key + "'", place, core::did_you_mean(key, known));
}

std::string shown_unit(const std::string& unit) {
    return unit == "m" ? "mm" : unit == "rad" ? "deg" : unit == "m^3/s" ? "mL/s" : unit;
}

std::string shown_value(double value, const std::string& unit, int digits) {
    const std::string shown = shown_unit(unit);
    return core::format_number(core::convert(value, unit, shown), digits) + (shown == "1" ? "" : " " + shown);
}

Tie tie_from(const core::TomlTable& table) {
    Tie tie;
    tie.key = table.string("key");
    tie.of = table.string("of");
    const std::string unit = parameter_unit(tie.key, table.place("key")),
                      of_unit = parameter_unit(tie.of, table.place("of"));
    if (unit.empty() || of_unit != unit) {
        throw core::InputError("unit", tie.key + " cannot be tied to " + tie.of + ": they are not of one kind",
                               table.place("of"));
    }
    tie.factor = table.quantity_or("factor", "1", 1);
    tie.offset = table.quantity_or("offset", unit, 0);
    return tie;
}

void apply(const Tie& tie, BodyShape& shape) {
    set_parameter(shape, tie.key, core::format_number(tie.factor * parameter(shape, tie.of) + tie.offset));
}

namespace {

std::vector<std::string> even_values(double from, double to, std::int64_t count, const std::string& unit) {
    std::vector<std::string> values;
    for (std::int64_t i = 0; i < count; ++i) {
        values.push_back(
            shown_value(from + (to - from) * static_cast<double>(i) / static_cast<double>(count - 1), unit, 12));
    }
    return values;
}

Vary vary_from(const core::TomlTable& table) {
    Vary vary;
    vary.key = table.string("key");
    const std::string unit = parameter_unit(vary.key, table.place("key"));
    if (unit.empty()) {
        vary.values = table.strings("values");
    } else if (table.has("values") || !table.has("from")) {  // without both the values are what is missing
        for (const double v : table.quantities("values", unit)) {
            vary.values.push_back(shown_value(v, unit, 12));
        }
    } else {
        const double from = table.quantity("from", unit), to = table.quantity("to", unit);
        const std::int64_t count = table.integer_or("count", 2);
        if (count < 2 || count > 100000) {
            throw core::InputError("range", table.path_of("count") + " is " + std::to_string(count),
                                   table.place("count"), "the nearest allowed value: 2");
        }
        vary.values = even_values(from, to, count, unit);
    }
    if (vary.values.empty()) {
        throw core::InputError("empty", table.path_of("values") + " is empty", table.place("values"));
    }
    return vary;
}

std::string numbered(const std::string& name, std::size_t index, std::size_t count) {
    const std::string digits = std::to_string(index + 1);
    const std::size_t width = std::max<std::size_t>(3, std::to_string(count).size());
    return name + "-" + std::string(width - digits.size(), '0') + digits;
}

double base_area(const SurfaceMesh& mesh) {
    for (const PatchSummary& patch : patches(mesh)) {
        if (patch.name == "base") {
            return patch.area;
        }
    }
    return 0;
}

}  // namespace

Vary vary_from(const std::string& text) {
    const auto equal = text.find('=');
    if (equal == std::string::npos || equal == 0) {
        throw core::UsageError("parse", "'" + text + "' is not PARAMETER=VALUES", {},
                               "such as protrusion.height=1mm:3mm:5 or body.base=ellipse,rectangle");
    }
    Vary vary;
    vary.key = core::trimmed(text.substr(0, equal));
    const std::string unit = parameter_unit(vary.key, {});
    const std::string values(core::trimmed(text.substr(equal + 1)));
    const auto parts = core::split(values, ':');
    if (!unit.empty() && parts.size() > 1) {
        const auto count = parts.size() == 3 ? core::parse_number(parts[2]) : std::optional<double>();
        if (!count || *count < 2 || *count > 100000 || *count != std::floor(*count)) {
            throw core::UsageError("parse", "'" + values + "' is not FROM:TO:COUNT with two values or more", {},
                                   "such as 1mm:3mm:5");
        }
        vary.values =
            even_values(core::parse_in(core::trimmed(parts[0]), unit), core::parse_in(core::trimmed(parts[1]), unit),
                        static_cast<std::int64_t>(*count), unit);
        return vary;
    }
    for (const auto& part : core::split(values, ',')) {
        const std::string one(core::trimmed(part));
        if (one.empty()) {
            throw core::UsageError("parse", "a value of '" + vary.key + "' is empty", {},
                                   "write VALUE,VALUE or FROM:TO:COUNT");
        }
        vary.values.push_back(unit.empty() ? one : shown_value(core::parse_in(one, unit), unit, 12));
    }
    return vary;
}

VariantSet variants_of(const BodyShape& shape, const std::string& name, const std::vector<Vary>& varies,
                       const std::vector<Tie>& ties) {
    VariantSet set;
    set.name = name;
    std::size_t count = 1;
    for (const Vary& vary : varies) {
        set.keys.push_back(vary.key);
        count *= vary.values.size();
        if (count > 100000) {
            throw core::InputError("size", "more than 100000 variants", {}, "vary less, or in steps");
        }
    }
    std::map<std::string, std::string> seen;
    for (std::size_t i = 0; i < count; ++i) {
        Variant variant;
        variant.name = numbered(name, i, count);
        variant.shape = shape;
        variant.shape.name = variant.name;
        variant.values.resize(varies.size());
        std::size_t rest = i;
        for (std::size_t k = varies.size(); k-- > 0;) {
            variant.values[k] = varies[k].values[rest % varies[k].values.size()];
            rest /= varies[k].values.size();
        }
        try {
            for (std::size_t k = 0; k < varies.size(); ++k) {
                set_parameter(variant.shape, varies[k].key, variant.values[k]);
            }
            for (const Tie& tie : ties) {
                apply(tie, variant.shape);
            }
            check(variant.shape);
            const auto [found, fresh] = seen.emplace(shape_hash(variant.shape), variant.name);
            variant.same_as = fresh ? "" : found->second;
        } catch (const core::InputError& error) {
            variant.refused = error.message() + (error.hint().empty() ? "" : "; " + error.hint());
        }
        set.variants.push_back(std::move(variant));
    }
    return set;
}

VariantSet read_variants(const std::filesystem::path& path) {
    const core::TomlTable root = core::read_toml(path, shape_format());
    const std::string name = path.stem().string();
    std::vector<Vary> varies;
    std::vector<Tie> ties;
    std::size_t count = 1;
    for (const core::TomlTable& table : root.tables("vary")) {
        varies.push_back(vary_from(table));
        count *= varies.back().values.size();
        if (count > 100000) {
            throw core::InputError("size", "more than 100000 variants", table.place("key"), "vary less, or in steps");
        }
    }
    if (varies.empty()) {
        throw core::InputError("missing", "there is no [[vary]] in it", root.place(),
                               "add: [[vary]] key = \"protrusion.height\" values = [\"1 mm\", \"2 mm\"]");
    }
    for (const core::TomlTable& table : root.tables("tie")) {
        ties.push_back(tie_from(table));
    }
    const BodyShape common = shape_from(root, name);
    static_cast<void>(loading_from(root));  // a typo in [mass] is an error here too
    root.finish();
    return variants_of(common, name, varies, ties);
}

std::vector<MadeVariant> make_variants(VariantSet& set, std::size_t triangles, core::Progress& progress) {
    std::vector<MadeVariant> made(set.variants.size());
    core::parallel_for(
        set.variants.size(),
        [&](std::size_t i) {
            Variant& variant = set.variants[i];
            made[i].variant = &variant;
            if (!variant.refused.empty() || !variant.same_as.empty()) {
                return;
            }
            SurfaceOptions options;
            options.triangles = triangles;
            try {
                made[i].mesh = make_surface(variant.shape, options, progress);
                made[i].certificate = certify(made[i].mesh, variant.shape, progress);
                require(made[i].certificate, variant.name);
                made[i].mass = mass_properties(ExactBody(variant.shape), made[i].mesh);
            } catch (const core::InputError& error) {
                variant.refused = error.message();
                made[i].mesh = {};
            }
        },
        progress);
    return made;
}

namespace {

double value_of(const MadeVariant& m, const std::string& column) {
    return column == "volume"             ? m.mass.volume
           : column == "area"             ? m.mass.area
           : column == "base_area"        ? base_area(m.mesh)
           : column == "buoyancy"         ? m.mass.buoyancy()
           : column == "centroid_x"       ? m.mass.centroid.x
           : column == "centroid_z"       ? m.mass.centroid.z
           : column == "smallest_angle"   ? m.certificate.smallest_angle
           : column == "distance_largest" ? m.certificate.exact->distance_largest
                                          : m.certificate.exact->volume_error;
}

}  // namespace

const std::vector<VariantColumn>& variant_columns() {
    static const std::vector<VariantColumn> columns = {
        {"volume", "m^3", "cm^3"},        {"area", "m^2", "cm^2"},         {"base_area", "m^2", "cm^2"},
        {"buoyancy", "N", "N"},           {"centroid_x", "m", "mm"},       {"centroid_z", "m", "mm"},
        {"smallest_angle", "rad", "deg"}, {"distance_largest", "m", "mm"}, {"volume_error", "1", "1"}};
    return columns;
}

core::Table table(const VariantSet& set, const std::vector<MadeVariant>& made) {
    core::Table result;
    std::vector<std::string> names, same, refused;
    for (const Variant& v : set.variants) {
        names.push_back(v.name);
        same.push_back(v.same_as.empty() ? "-" : v.same_as);
        std::string reason = v.refused.empty() ? "-" : v.refused;
        for (char& c : reason) {
            c = c == ',' || c == '\n' ? ';' : c;  // one field of a CSV line
        }
        refused.push_back(reason);
    }
    result.add_text("name", names);
    for (std::size_t k = 0; k < set.keys.size(); ++k) {
        const std::string unit = parameter_unit(set.keys[k], {});
        std::vector<std::string> words;
        std::vector<double> numbers;
        for (const Variant& v : set.variants) {
            words.push_back(v.values[k]);
            numbers.push_back(unit.empty() ? 0 : core::parse_in(v.values[k], unit));
        }
        if (unit.empty()) {
            result.add_text(set.keys[k], words);
        } else {
            result.add_numbers(set.keys[k], unit, numbers, shown_unit(unit));
        }
    }
    for (const VariantColumn& column : variant_columns()) {
        std::vector<double> numbers;
        for (const MadeVariant& m : made) {
            numbers.push_back(m.mesh.triangles.empty() ? std::nan("") : value_of(m, column.name));
        }
        result.add_numbers(column.name, column.unit, numbers, column.shown);
    }
    result.add_text("same_as", same);
    result.add_text("refused", refused);
    return result;
}

}  // namespace underbody::geometry
