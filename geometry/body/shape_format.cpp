#include "geometry/body/shape_format.h"

#include "core/text.h"
#include "geometry/body/body_shape.h"

namespace underbody::geometry {

namespace shape_keys {

std::string millimetres(double metres) { return core::format_number(metres * 1e3, 6) + " mm"; }

core::FileTable body() {
    return {"body",
            "the ellipsoid and its flat base",
            {{"length", "m", "\"203.2 mm\"", "", "whole length of the ellipsoid, along x"},
             {"width", "m", "\"152 mm\"", "", "whole width of the ellipsoid, along y"},
             {"height", "m", "\"145 mm\"", "",
              "whole height of the ellipsoid before it is cut; the body is height (1 + base_cut) / 2 high"},
             {"base_cut", "1", "0.75", "",
              "how far below the centre the flat base lies, in semi-heights: 0 cuts at the centre, near 1 leaves a "
              "small base"},
             {"base", "ellipse | rectangle | ellipse_front", "\"ellipse\"", "ellipse", "outline of the flat base"},
             {"base_length", "m", "\"95 mm\"", "the largest rectangle inside the base ellipse",
              "length of a rectangular base"},
             {"base_width", "m", "\"71 mm\"", "the largest rectangle inside the base ellipse",
              "width of a rectangular base"},
             {"edge_radius", "m", "\"2 mm\"", "0", "radius of the rounding between base and hull"},
             {"taper", "1", "0.1", "0", "share of its width by which the base narrows from nose to tail"},
             {"base_pitch", "rad", "\"1 deg\"", "0", "tilt of the base about its centre, positive nose up"},
             {"base_offset", "m", "\"-20 mm\"", "0",
              "how far the base lies forward (negative: aft) of where the cut leaves it; the hull below the midplane "
              "follows"},
             {"name", "text", "\"ellipse\"", "the name of the file", "name of the body in reports"}},
            true};
}

core::FileTable protrusion() {
    const Protrusion usual;
    return {"protrusion",
            "a ridge across the base",
            {{"position", "1", "0.85", core::format_number(usual.position),
              "where its axis lies along the base: 0 is the front end of the base, 1 its rear end"},
             {"height", "m", "\"2 mm\"", "", "how far it stands below the base"},
             {"length", "m", "\"10 mm\"", millimetres(usual.length), "its extent along x, foot to foot"},
             {"profile", "rounded | sharp", "\"rounded\"", "rounded", "section: a circular arc, or two flanks"},
             {"blend_radius", "m", "\"1 mm\"", "0", "radius of the fillet between base and ridge"},
             {"width", "m", "\"60 mm\"", "as wide as the base allows there", "its extent along y, tip to tip"}}};
}

core::FileTable nozzle() {
    const Nozzle usual;
    return {"nozzle",
            "a round opening in the base for a jet",
            {{"diameter", "m", "\"5 mm\"", millimetres(usual.diameter), "diameter of the opening"},
             {"position", "1", "0.5", core::format_number(usual.position),
              "where its centre lies along the base: 0 is the front end of the base, 1 its rear end"},
             {"depth", "m", "\"10 mm\"", "0 (flush)", "depth of the bore above the base"}}};
}

core::FileTable tail_plate() {
    return {
        "tail_plate",
        "a level plate without thickness on the stern, at the ellipsoid's midplane (meshes of blocks alone have it)",
        {{"chord", "m", "\"50 mm\"", "", "its length aft of the tail; 0: none"},
         {"half_angle", "rad", "\"60 deg\"", "60 deg",
          "how far it reaches round the stern to each side, seen from above"},
         {"inner_angle", "rad", "\"35 deg\"", "0",
          "where it begins, seen from above: two fins with a clear tail between them"}}};
}

std::vector<core::FileTable> loading() {
    return {{"mass",
             "what the body weighs: for trim and ballast",
             {{"hull", "kg", "\"1.4 kg\"", "0", "mass of the hull, spread evenly over its volume"},
              {"density", "kg/m^3", "\"620 kg/m^3\"", "", "density of the hull over its whole volume", "hull"}}},
            {"mass.point[]",
             "a point mass: a battery, a piece of lead",
             {{"name", "text", "\"battery\"", "", "name of the mass"},
              {"mass", "kg", "\"0.5 kg\"", "", "its mass"},
              {"position", "list of m", "[\"20 mm\", \"0 mm\", \"15 mm\"]", "",
               "x forward, y to port, z up, from the centre of the base"}}}};
}

std::vector<core::FileTable> variation() {
    return {{"vary[]",
             "a parameter that takes several values: one body for each (all combinations of several)",
             {{"key", "text", "\"protrusion.height\"", "", "the parameter: table and key as above"},
              {"values", "list of texts or numbers with units", "[\"1 mm\", \"2 mm\"]", "", "its values"},
              {"from", "the unit of the key", "\"1 mm\"", "", "first value of a range", "values"},
              {"to", "the unit of the key", "\"3 mm\"", "", "last value of a range", "values"},
              {"count", "whole number", "5", "2", "how many values from first to last", "values"}}},
            {"tie[]",
             "a parameter that follows another: key = factor * of + offset",
             {{"key", "text", "\"protrusion.length\"", "", "the parameter that follows"},
              {"of", "text", "\"protrusion.height\"", "", "the parameter that it follows"},
              {"factor", "1", "5", "1", "factor"},
              {"offset", "the unit of the key", "\"0 mm\"", "0", "offset"}}}};
}

}  // namespace shape_keys

const core::FileFormat& shape_format() {
    static const core::FileFormat format = [] {
        core::FileFormat made{"shape", "SHAPE.toml", "a body: an ellipsoid with a flat base", {}};
        made.tables = {shape_keys::body(), shape_keys::protrusion(), shape_keys::nozzle(), shape_keys::tail_plate()};
        for (auto& table : shape_keys::loading()) {
            made.tables.push_back(std::move(table));
        }
        for (auto& table : shape_keys::variation()) {
            made.tables.push_back(std::move(table));
        }
        return made;
    }();
    return format;
}

}  // namespace underbody::geometry
