#include "geometry/body/body_shape.h"

#include <cmath>
#include <numbers>

#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"
#include "geometry/body/loading.h"
#include "geometry/body/shape_format.h"

namespace underbody::geometry {

const std::vector<std::string>& base_names() {
    static const std::vector<std::string> names{"ellipse", "rectangle", "ellipse_front"};
    return names;
}

std::string name_of(BaseKind base) { return base_names()[static_cast<std::size_t>(base)]; }

std::string name_of(ProtrusionProfile profile) { return profile == ProtrusionProfile::rounded ? "rounded" : "sharp"; }

BodyShape::BaseExtent BodyShape::base_extent() const {
    const double scale = std::sqrt(1 - base_cut * base_cut) / 2;
    const double nose = scale * length, half_width = scale * width;
    if (base == BaseKind::ellipse) {
        return {nose, -nose, half_width};
    }
    const double x = base_length ? *base_length / 2 : nose / std::numbers::sqrt2;
    const double y = base_width ? *base_width / 2 : half_width / std::numbers::sqrt2;
    return {base == BaseKind::ellipse_front ? nose : x, -x, y};
}

double BodyShape::base_x(double fraction) const {
    const BaseExtent extent = base_extent();
    return extent.nose + fraction * (extent.tail - extent.nose);
}

namespace {

Protrusion protrusion_from(const core::TomlTable& table) {
    Protrusion p;
    p.position = table.quantity_or("position", "1", p.position);
    p.height = table.quantity("height", "m");
    p.length = table.quantity_or("length", "m", p.length);
    p.profile = table.choice("profile", {"rounded", "sharp"}, "rounded") == "sharp" ? ProtrusionProfile::sharp
                                                                                    : ProtrusionProfile::rounded;
    p.blend_radius = table.quantity_or("blend_radius", "m", 0);
    p.width = table.find_quantity("width", "m");
    return p;
}

Nozzle nozzle_from(const core::TomlTable& table) {
    Nozzle n;
    n.diameter = table.quantity_or("diameter", "m", n.diameter);
    n.position = table.quantity_or("position", "1", n.position);
    n.depth = table.quantity_or("depth", "m", 0);
    return n;
}

TailPlate tail_plate_from(const core::TomlTable& table) {
    TailPlate plate;
    plate.chord = table.quantity("chord", "m");
    plate.half_angle = table.quantity_or("half_angle", "rad", plate.half_angle);
    plate.inner_angle = table.quantity_or("inner_angle", "rad", plate.inner_angle);
    return plate;
}

}  // namespace

BodyShape shape_from(const core::TomlTable& root, const std::string& name) {
    BodyShape shape;
    const core::TomlTable body = root.table("body");
    shape.name = body.string_or("name", name);
    shape.length = body.quantity("length", "m");
    shape.width = body.quantity("width", "m");
    shape.height = body.quantity("height", "m");
    shape.base_cut = body.quantity("base_cut", "1");
    const std::string base = body.choice("base", base_names(), "ellipse");
    for (std::size_t i = 0; i < base_names().size(); ++i) {
        if (base == base_names()[i]) {
            shape.base = static_cast<BaseKind>(i);
        }
    }
    shape.base_length = body.find_quantity("base_length", "m");
    shape.base_width = body.find_quantity("base_width", "m");
    shape.edge_radius = body.quantity_or("edge_radius", "m", 0);
    shape.taper = body.quantity_or("taper", "1", 0);
    shape.base_pitch = body.quantity_or("base_pitch", "rad", 0);
    shape.base_offset = body.quantity_or("base_offset", "m", 0);
    if (root.has("protrusion")) {
        shape.protrusion = protrusion_from(root.table("protrusion"));
    }
    if (root.has("nozzle")) {
        shape.nozzle = nozzle_from(root.table("nozzle"));
    }
    if (root.has("tail_plate")) {
        shape.tail_plate = tail_plate_from(root.table("tail_plate"));
    }
    check(shape, &root);
    return shape;
}

BodyShape read_shape(const std::filesystem::path& path) {
    const core::TomlTable root = core::read_toml(path, shape_format());
    BodyShape shape = shape_from(root, path.stem().string());
    loading_from(root);  // a typo in [mass] is an error here too
    root.finish();
    return shape;
}

BodyShape parse_shape(std::string_view text, const std::string& source) {
    const core::TomlTable root = core::read_toml_text(text, source, ".", shape_format());
    BodyShape shape = shape_from(root, std::filesystem::path(source).stem().string());
    loading_from(root);
    root.finish();
    return shape;
}

namespace {

std::string length_text(double metres) {
    // 203.2 mm is what people write; the digits must still read back to the same metres.
    return "\"" + core::format_number(metres) + " m\"";
}

}  // namespace

std::string write_shape(const BodyShape& shape) {
    const auto number = [](double v) { return core::format_number(v); };
    std::string out = "[body]\nname = " + core::toml_string(shape.name) + "\nlength = " + length_text(shape.length) +
                      "\nwidth = " + length_text(shape.width) + "\nheight = " + length_text(shape.height) +
                      "\nbase_cut = " + number(shape.base_cut) + "\nbase = " + core::toml_string(name_of(shape.base)) +
                      "\n";
    const auto optional_length = [&](const char* key, const std::optional<double>& value) {
        if (value) {
            out += std::string(key) + " = " + length_text(*value) + "\n";
        }
    };
    optional_length("base_length", shape.base_length);
    optional_length("base_width", shape.base_width);
    out += "edge_radius = " + length_text(shape.edge_radius) + "\ntaper = " + number(shape.taper) +
           "\nbase_pitch = \"" + number(shape.base_pitch) + " rad\"\nbase_offset = " + length_text(shape.base_offset) +
           "\n";
    if (shape.protrusion) {
        const Protrusion& p = *shape.protrusion;
        out += "\n[protrusion]\nposition = " + number(p.position) + "\nheight = " + length_text(p.height) +
               "\nlength = " + length_text(p.length) + "\nprofile = " + core::toml_string(name_of(p.profile)) +
               "\nblend_radius = " + length_text(p.blend_radius) + "\n";
        optional_length("width", p.width);
    }
    if (shape.nozzle) {
        out += "\n[nozzle]\ndiameter = " + length_text(shape.nozzle->diameter) +
               "\nposition = " + number(shape.nozzle->position) + "\ndepth = " + length_text(shape.nozzle->depth) +
               "\n";
    }
    if (shape.tail_plate) {
        out += "\n[tail_plate]\nchord = " + length_text(shape.tail_plate->chord) + "\nhalf_angle = \"" +
               number(shape.tail_plate->half_angle) + " rad\"\ninner_angle = \"" +
               number(shape.tail_plate->inner_angle) + " rad\"\n";
    }
    return out;
}

double tail_plate_area(const BodyShape& shape) {
    const TailPlate* plate = tail_plate(shape);
    if (plate == nullptr) {
        return 0;
    }
    // Where the ellipsoid's outline is a circle areas are the same: between two circles, within the ray's angle there.
    const double a = shape.length / 2, b = shape.width / 2, outer = 1 + plate->chord / a;
    const auto ray = [&](double angle) { return std::atan2(a * std::sin(angle), b * std::cos(angle)); };
    return (ray(plate->half_angle) - ray(plate->inner_angle)) * a * b * (outer * outer - 1);
}

std::string shape_hash(const BodyShape& shape) {
    core::Hasher hasher;
    const double scale = shape.length;
    // Twelve digits: the same length written in other units differs in its last bits.
    const auto number = [&](double v) { hasher.add(core::format_number(v == 0 ? 0.0 : v, 12)); };
    const BodyShape::BaseExtent extent = shape.base_extent();
    number(shape.length), number(shape.width), number(shape.height), number(shape.base_cut);
    hasher.add(name_of(shape.base));
    number(extent.tail / scale), number(extent.half_width / scale);
    number(shape.edge_radius), number(shape.taper), number(shape.base_pitch);
    if (shape.base_offset != 0) {  // shapes from before there was one keep their hash
        hasher.add("base_offset");
        number(shape.base_offset);
    }
    if (shape.protrusion && shape.protrusion->height > 0) {
        const Protrusion& p = *shape.protrusion;
        hasher.add("protrusion").add(name_of(p.profile));
        number(p.position), number(p.height), number(p.length), number(p.blend_radius), number(protrusion_width(shape));
    }
    if (shape.nozzle) {
        hasher.add("nozzle");
        number(shape.nozzle->diameter), number(shape.nozzle->position), number(shape.nozzle->depth);
    }
    if (const TailPlate* plate = tail_plate(shape)) {
        hasher.add("tail_plate");
        number(plate->chord), number(plate->half_angle), number(plate->inner_angle);
    }
    return hasher.digest();
}

}  // namespace underbody::geometry
