#include "geometry/body/loading.h"

#include "core/error.h"
#include "core/text.h"
#include "geometry/body/shape_format.h"

namespace underbody::geometry {

namespace {

double positive(const core::TomlTable& table, const char* key, const char* unit) {
    const double value = table.quantity(key, unit);
    if (!(value > 0)) {
        throw core::InputError(
            "range", table.path_of(key) + " is " + core::format_number(value, 6) + " " + unit + ": it must be positive",
            table.place(key), "the nearest allowed value: above 0");
    }
    return value;
}

}  // namespace

std::optional<Loading> loading_from(const core::TomlTable& root) {
    if (!root.has("mass")) {
        return {};
    }
    const core::TomlTable table = root.table("mass");
    Loading loading;
    if (table.has("hull") && table.has("density")) {
        throw core::InputError("conflict", "mass.hull and mass.density say the same thing twice",
                               table.place("density"), "leave one out");
    }
    if (table.has("hull")) {
        loading.hull_mass = positive(table, "hull", "kg");
    }
    if (table.has("density")) {
        loading.uniform_density = positive(table, "density", "kg/m^3");
    }
    for (const core::TomlTable& entry : table.tables("point")) {
        PointMass point;
        point.name = entry.string("name");
        point.mass = positive(entry, "mass", "kg");
        const std::vector<double> position = entry.quantities("position", "m");
        if (position.size() != 3) {
            throw core::InputError(
                "size", entry.path_of("position") + " has " + std::to_string(position.size()) + " numbers",
                entry.place("position"), "three: x forward, y to port, z up from the centre of the base");
        }
        point.position = {position[0], position[1], position[2]};
        loading.points.push_back(point);
    }
    return loading;
}

std::optional<Loading> read_loading(const std::filesystem::path& path) {
    const core::TomlTable root = core::read_toml(path, shape_format());
    return loading_from(root);
}

}  // namespace underbody::geometry
