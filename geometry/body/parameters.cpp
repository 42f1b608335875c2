// Parameters of a shape by name.
#include <functional>

#include "core/error.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/body/variants.h"

namespace underbody::geometry {

namespace {

struct Parameter {
    ParameterName name;
    std::function<void(BodyShape&, double)> set;
    std::function<double(const BodyShape&)> get;
};

Protrusion& protrusion(BodyShape& shape) { return shape.protrusion ? *shape.protrusion : shape.protrusion.emplace(); }
TailPlate& plate(BodyShape& shape) { return shape.tail_plate ? *shape.tail_plate : shape.tail_plate.emplace(); }
Nozzle& nozzle(BodyShape& shape) { return shape.nozzle ? *shape.nozzle : shape.nozzle.emplace(); }

const std::vector<Parameter>& numbers() {
    using S = BodyShape;
    static const std::vector<Parameter> list{
        {{"body.length", "m"}, [](S& s, double v) { s.length = v; }, [](const S& s) { return s.length; }},
        {{"body.width", "m"}, [](S& s, double v) { s.width = v; }, [](const S& s) { return s.width; }},
        {{"body.height", "m"}, [](S& s, double v) { s.height = v; }, [](const S& s) { return s.height; }},
        {{"body.base_cut", "1"}, [](S& s, double v) { s.base_cut = v; }, [](const S& s) { return s.base_cut; }},
        {{"body.base_length", "m"},
         [](S& s, double v) { s.base_length = v; },
         [](const S& s) { return -2 * s.base_extent().tail; }},
        {{"body.base_width", "m"},
         [](S& s, double v) { s.base_width = v; },
         [](const S& s) { return 2 * s.base_extent().half_width; }},
        {{"body.edge_radius", "m"},
         [](S& s, double v) { s.edge_radius = v; },
         [](const S& s) { return s.edge_radius; }},
        {{"body.taper", "1"}, [](S& s, double v) { s.taper = v; }, [](const S& s) { return s.taper; }},
        {{"body.base_pitch", "rad"}, [](S& s, double v) { s.base_pitch = v; }, [](const S& s) { return s.base_pitch; }},
        {{"body.base_offset", "m"},
         [](S& s, double v) { s.base_offset = v; },
         [](const S& s) { return s.base_offset; }},
        {{"protrusion.position", "1"},
         [](S& s, double v) { protrusion(s).position = v; },
         [](const S& s) { return s.protrusion->position; }},
        {{"protrusion.height", "m"},
         [](S& s, double v) { protrusion(s).height = v; },
         [](const S& s) { return s.protrusion->height; }},
        {{"protrusion.length", "m"},
         [](S& s, double v) { protrusion(s).length = v; },
         [](const S& s) { return s.protrusion->length; }},
        {{"protrusion.blend_radius", "m"},
         [](S& s, double v) { protrusion(s).blend_radius = v; },
         [](const S& s) { return s.protrusion->blend_radius; }},
        {{"protrusion.width", "m"},
         [](S& s, double v) { protrusion(s).width = v; },
         [](const S& s) { return protrusion_width(s); }},
        {{"nozzle.diameter", "m"},
         [](S& s, double v) { nozzle(s).diameter = v; },
         [](const S& s) { return s.nozzle->diameter; }},
        {{"nozzle.position", "1"},
         [](S& s, double v) { nozzle(s).position = v; },
         [](const S& s) { return s.nozzle->position; }},
        {{"nozzle.depth", "m"},
         [](S& s, double v) { nozzle(s).depth = v; },
         [](const S& s) { return s.nozzle->depth; }},
        {{"tail_plate.chord", "m"},
         [](S& s, double v) { plate(s).chord = v; },
         [](const S& s) { return s.tail_plate->chord; }},
        {{"tail_plate.half_angle", "rad"},
         [](S& s, double v) { plate(s).half_angle = v; },
         [](const S& s) { return s.tail_plate->half_angle; }},
        {{"tail_plate.inner_angle", "rad"},
         [](S& s, double v) { plate(s).inner_angle = v; },
         [](const S& s) { return s.tail_plate->inner_angle; }},
    };
    return list;
}

[[noreturn]] void unknown(const std::string& name) {
    std::vector<std::string> known;
    for (const ParameterName& p : parameter_names()) {
        known.push_back(p.name);
    }
    throw core::InputError("name", "a shape has no parameter '" + name + "'", {}, core::did_you_mean(name, known));
}

}  // namespace

const std::vector<ParameterName>& parameter_names() {
    static const std::vector<ParameterName> names = [] {
        std::vector<ParameterName> list{{"body.base", ""}, {"protrusion.profile", ""}};
        for (const Parameter& p : numbers()) {
            list.push_back(p.name);
        }
        return list;
    }();
    return names;
}

bool has_part_of(const BodyShape& shape, const std::string& name) {
    return !(name.starts_with("protrusion.") && !shape.protrusion) && !(name.starts_with("nozzle.") && !shape.nozzle) &&
           !(name.starts_with("tail_plate.") && !shape.tail_plate);
}

void set_parameter(BodyShape& shape, const std::string& name, const std::string& text) {
    const auto choice = [&](const std::vector<std::string>& words) {
        for (std::size_t i = 0; i < words.size(); ++i) {
            if (words[i] == text) {
                return i;
            }
        }
        throw core::InputError("choice", name + " is '" + text + "'", {}, core::did_you_mean(text, words));
    };
    if (name == "body.base") {
        shape.base = static_cast<BaseKind>(choice(base_names()));
        return;
    }
    if (name == "protrusion.profile") {
        protrusion(shape).profile = static_cast<ProtrusionProfile>(choice({"rounded", "sharp"}));
        return;
    }
    set_parameter(shape, name, core::parse_in(text, parameter_unit(name, {})));
}

void set_parameter(BodyShape& shape, const std::string& name, double value) {
    for (const Parameter& p : numbers()) {
        if (p.name.name == name) {
            p.set(shape, value);
            return;
        }
    }
    unknown(name);
}

double parameter(const BodyShape& shape, const std::string& name) {
    for (const Parameter& p : numbers()) {
        if (p.name.name == name) {
            if (!has_part_of(shape, name)) {
                throw core::InputError("missing", "the shape has no " + name.substr(0, name.find('.')) + " whose " +
                                                      name + " could be taken");
            }
            return p.get(shape);
        }
    }
    if (name == "body.base" || name == "protrusion.profile") {
        throw core::InputError("choice", name + " is a word, not a number");
    }
    unknown(name);
}

}  // namespace underbody::geometry
